#pragma once

/// Bit and packet errors. Signal to noise ratios of formulas are linear energy ratios
/// gamma = Eb/N0 (J. G. Proakis, Digital Communications, 4th edition, chapters 5 and 14).
namespace stg::acoustics {

double DbToRatio(double db);
double RatioToDb(double ratio);

/// Coherent BPSK without fading: erfc(sqrt(gamma)) / 2.
double BpskBitError(double gamma);
/// Non-coherent orthogonal BFSK without fading: exp(-gamma / 2) / 2.
double NoncoherentFskBitError(double gamma);
/// Both with independent fading of each bit: Rayleigh with mean gamma, and Rice with K.
double RayleighBpskBitError(double gamma);
double RayleighNoncoherentFskBitError(double gamma);
double RicianNoncoherentFskBitError(double gamma, double rician_k);

/// How noise destroys a modem's frames.
struct ErrorCurve {
  enum class Kind {
    kNone,            ///< nothing is ever lost
    kBpsk,            ///< uncoded, coherent
    kNoncoherentFsk,  ///< uncoded, binary
    kCoded,           ///< a measured curve of frames, see below
  };
  Kind kind = Kind::kNoncoherentFsk;

  /// Uncoded: bandwidth over bit rate [dB], by which Eb/N0 is above the ratio in the band.
  double processing_gain_db = 0.0;

  /// Coded: a frame of `frame_bits` is lost with probability 1/2 at this ratio in the band [dB];
  /// the exponent of its success falls by ten over `decade_db`: P = 2^-x, x = 10^((half - snr) /
  /// decade). At 1.5 dB the success rises from 0.1 to 0.9 in 2 dB.
  double half_db = 0.0;
  double frame_bits = 256.0;
  double decade_db = 1.5;

  /// ln of the probability that `bits` bits are received at this ratio of signal to interference
  /// and noise in the band [dB]; -infinity: none can be. Pieces of a packet add up.
  double LogSuccess(double sinr_db, double bits) const;
};

/// Coded PSK of the WHOI Micromodem at rate 1, 3 or 5: frames of 64, 256 and 256 bytes, half of
/// them lost at -7.1, -1.5 and 3.9 dB. Any other rate throws std::invalid_argument.
ErrorCurve CodedPskCurve(int rate);

}  // namespace stg::acoustics
