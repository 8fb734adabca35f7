#if defined(__AVX__) && !defined(__AVX512F__)
#include <immintrin.h>
#endif

#include "env_internal.hpp"

namespace stg::env {
namespace {

/// Turns columns of packs into one float row per lane.
void Scatter(const Pack* columns, int size, float* rows, size_t stride) {
  int c = 0;
#if defined(__AVX__) && !defined(__AVX512F__)
  // Four columns of four lanes at a time: a quarter of the time of single stores.
  static_assert(kLanes == 4, "AVX holds four doubles");
  for (; c + 4 <= size; c += 4) {
    __m128 r0 = _mm256_cvtpd_ps(columns[c]);
    __m128 r1 = _mm256_cvtpd_ps(columns[c + 1]);
    __m128 r2 = _mm256_cvtpd_ps(columns[c + 2]);
    __m128 r3 = _mm256_cvtpd_ps(columns[c + 3]);
    _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
    _mm_storeu_ps(rows + c, r0);
    _mm_storeu_ps(rows + stride + c, r1);
    _mm_storeu_ps(rows + 2 * stride + c, r2);
    _mm_storeu_ps(rows + 3 * stride + c, r3);
  }
#endif
  alignas(64) double buffer[kLanes];
  for (; c < size; ++c) {
    columns[c].store_aligned(buffer);
    for (int lane = 0; lane < kLanes; ++lane) {
      rows[static_cast<size_t>(lane) * stride + static_cast<size_t>(c)] =
          static_cast<float>(buffer[lane]);
    }
  }
}

constexpr int kLargestObservation = 74;

}  // namespace

void EnvGroup::WriteObservations() {
  const auto size = static_cast<size_t>(observation_size_);
  const size_t stride = truth_.size() * size;
  Pack columns[kLargestObservation];
  for (size_t i = 0; i < truth_.size(); ++i) {
    agent::BuildObservation(scenario_, acoustic_ ? acoustic_->agents[i].knowledge() : truth_[i],
                            [&](int index, const Pack& value) { columns[index] = value; });
    Scatter(columns, observation_size_, observations_.data() + i * size, stride);
  }
}

void EnvGroup::WriteStates() {
  const auto size = static_cast<size_t>(state_size());
  const auto& vm = scenario_.vehicle.max_velocity_mps;
  const auto& wm = scenario_.vehicle.max_rate_radps;
  const Vec3<double> inv_v{1.0 / vm[0], 1.0 / vm[1], 1.0 / vm[2]};
  const Vec3<double> inv_w{1.0 / wm[0], 1.0 / wm[1], 1.0 / wm[2]};
  float* out = states_.data();
  Pack c[19];
  for (const auto& k : truth_) {
    int n = 0;
    const auto put3 = [&](const Vec3<Pack>& v) {
      c[n] = v.x;
      c[n + 1] = v.y;
      c[n + 2] = v.z;
      n += 3;
    };
    // The band is two hundredths of the workspace wide: give the critic the
    // same offset at both scales.
    put3(k.r_BT_W);
    put3(Clip(k.r_BT_W * Pack(1.0 / 0.05), -1.0, 1.0));
    put3(Scale(k.v_WT - k.v_WB, inv_v));
    put3(Scale(k.w_WB_B, inv_w));
    put3({k.tau[0], k.tau[1], k.tau[2]});
    put3({Clip((k.distance - Pack(scenario_.task.desired_distance_m)) * Pack(1.0 / 0.05),
               Pack(-1.0), Pack(1.0)),
          agent::Progress(scenario_.observation, k.previous_distance, k.distance), k.lost});
    c[n] = k.trig.cos_phi * k.trig.cos_theta;
    Scatter(c, 19, out, size);
    out += 19;
  }
  for (int t = 0; t < world_.targets(); ++t) {
    const dynamics::TargetState<Pack>& s = world_.target(t);
    const Vec3<Pack> v = Scale(s.v_WT, inv_v) * Pack(20.0);
    const Pack columns[6] = {s.p_WT.x, s.p_WT.y, s.p_WT.z, v.x, v.y, v.z};
    Scatter(columns, 6, out, size);
    out += 6;
  }
}

}  // namespace stg::env
