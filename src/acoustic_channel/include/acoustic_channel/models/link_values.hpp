#pragma once

namespace stg::acoustics {

/// Values of a link by a propagation model.
template <class T>
struct LinkValues {
  T loss;     ///< probability that a packet is lost
  T quality;  ///< [0, 1]
};

}  // namespace stg::acoustics
