#include "acoustic_channel/modem/error_rate.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace stg::acoustics {

double DbToRatio(double db) { return std::pow(10.0, db / 10.0); }
double RatioToDb(double ratio) { return 10.0 * std::log10(ratio); }

double BpskBitError(double gamma) { return 0.5 * std::erfc(std::sqrt(gamma)); }

double NoncoherentFskBitError(double gamma) { return 0.5 * std::exp(-0.5 * gamma); }

double RayleighBpskBitError(double gamma) { return 0.5 * (1.0 - std::sqrt(gamma / (1.0 + gamma))); }

double RayleighNoncoherentFskBitError(double gamma) { return 1.0 / (2.0 + gamma); }

double RicianNoncoherentFskBitError(double gamma, double rician_k) {
  const double sum = 2.0 * (1.0 + rician_k) + gamma;
  return (1.0 + rician_k) / sum * std::exp(-rician_k * gamma / sum);
}

double ErrorCurve::LogSuccess(double sinr_db, double bits) const {
  double bit_error = 0.0;
  switch (kind) {
    case Kind::kNone:
      return 0.0;
    case Kind::kBpsk:
      bit_error = BpskBitError(DbToRatio(sinr_db + processing_gain_db));
      break;
    case Kind::kNoncoherentFsk:
      bit_error = NoncoherentFskBitError(DbToRatio(sinr_db + processing_gain_db));
      break;
    case Kind::kCoded:
      return -std::log(2.0) * std::pow(10.0, (half_db - sinr_db) / decade_db) * bits / frame_bits;
  }
  return bits * std::log1p(-bit_error);
}

ErrorCurve CodedPskCurve(int rate) {
  ErrorCurve curve;
  curve.kind = ErrorCurve::Kind::kCoded;
  switch (rate) {
    case 1:
      curve.half_db = -7.1;
      curve.frame_bits = 64 * 8;
      return curve;
    case 3:
      curve.half_db = -1.5;
      curve.frame_bits = 256 * 8;
      return curve;
    case 5:
      curve.half_db = 3.9;
      curve.frame_bits = 256 * 8;
      return curve;
    default:
      throw std::invalid_argument("no error curve for PSK rate " + std::to_string(rate));
  }
}

}  // namespace stg::acoustics
