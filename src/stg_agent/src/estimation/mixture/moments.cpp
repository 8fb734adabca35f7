#include "moments.hpp"

namespace stg::agent {

void SetMoments(const GaussianMixture& mixture, bool drifts, TargetBelief* belief,
                TargetEstimate* estimate) {
  const int own = drifts ? kTargetStates : -1;
  const int stride = mixture.stride();
  Vec3<double> shift;
  for (int k = 0; k < mixture.size(); ++k) {
    const Gaussian g = mixture.at(k);
    const double w = *g.weight;
    belief->p_WT += Vec3<double>{g.x[0], g.x[1], g.x[2]} * w;
    belief->v_WT += Vec3<double>{g.x[3], g.x[4], g.x[5]} * w;
    if (own >= 0) shift += Vec3<double>{g.x[own], g.x[own + 1], 0.0} * w;
  }
  Covariance3& P = belief->P_WT;
  for (int k = 0; k < mixture.size(); ++k) {
    const Gaussian g = mixture.at(k);
    const double w = *g.weight;
    const Vec3<double> e = Vec3<double>{g.x[0], g.x[1], g.x[2]} - belief->p_WT;
    const auto cov = [&](int r, int c) { return g.P[r * stride + c]; };
    P.xx += w * (cov(0, 0) + e.x * e.x);
    P.xy += w * (cov(0, 1) + e.x * e.y);
    P.xz += w * (cov(0, 2) + e.x * e.z);
    P.yy += w * (cov(1, 1) + e.y * e.y);
    P.yz += w * (cov(1, 2) + e.y * e.z);
    P.zz += w * (cov(2, 2) + e.z * e.z);
    // Error of the estimate: the vehicle steers in the frame of its own navigation.
    Vec3<double> f = e;
    double own_x = cov(0, 0), own_y = cov(1, 1);
    if (own >= 0) {
      f += Vec3<double>{g.x[own], g.x[own + 1], 0.0} - shift;
      own_x += 2.0 * cov(0, own) + cov(own, own);
      own_y += 2.0 * cov(1, own + 1) + cov(own + 1, own + 1);
    }
    estimate->pp += w * (own_x + own_y + cov(2, 2) + Dot(f, f)) / 3.0;
    estimate->vv += w * (cov(3, 3) + cov(4, 4) + cov(5, 5)) / 3.0;
    estimate->pv += w * (cov(0, 3) + cov(1, 4) + cov(2, 5)) / 3.0;
  }
  estimate->p_WT = belief->p_WT + shift;
  estimate->v_WT = belief->v_WT;
}

}  // namespace stg::agent
