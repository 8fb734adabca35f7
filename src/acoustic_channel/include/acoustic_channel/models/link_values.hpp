#pragma once

namespace stg::acoustics {

/// What a propagation model says of a link.
template <class T>
struct LinkValues {
  T loss;     ///< probability that a packet is lost
  T quality;  ///< [0, 1]
};

}  // namespace stg::acoustics
