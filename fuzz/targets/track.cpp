#include "acoustic_channel/offline/track.hpp"

#include "target.hpp"

/// The path of a vehicle, as CSV.
bool stg::fuzz::RunTrack(const std::string& bytes) {
  return LoadAsFile(bytes, [](const std::string& path) {
    const acoustics::Track track = acoustics::Track::Load(path);
    Vec3<double> p_W, v_W;
    for (const double t_s : {-1.0, 0.0, 0.5, 1e9}) track.At(t_s, &p_W, &v_W);
  });
}
