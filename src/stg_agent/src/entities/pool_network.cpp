#include "stg_agent/entities/pool_network.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "auv_common/error.hpp"
#include "dense.hpp"

namespace stg::agent {
namespace {

void RequirePool(bool ok, const std::string& what) {
  if (!ok) throw UserError("policy: " + what);
}

}  // namespace

PoolBlocks::PoolBlocks(const PoolSpec& spec) {
  BlockPlaces places;
  for (const int n : spec.sets) {
    Set set;
    set.first = places.Layer(spec.width, n);
    set.second = places.Layer(spec.width, spec.width);
    set.nobody = places.Block(spec.width, 1);
    sets.push_back(set);
  }
  self = places.Layer(spec.hidden, spec.self);
  trunk1 = places.Layer(spec.hidden, spec.joined());
  trunk2 = places.Layer(spec.hidden, spec.hidden);
  head = places.Layer(spec.outputs, spec.hidden);
  size = places.size();
}

std::vector<PoolBlock> PoolBlocks::all() const {
  std::vector<PoolBlock> blocks;
  for (const Set& s : sets) {
    for (const PoolBlock& b :
         {s.first.weight, s.first.bias, s.second.weight, s.second.bias, s.nobody}) {
      blocks.push_back(b);
    }
  }
  for (const Layer& l : {self, trunk1, trunk2, head}) {
    blocks.push_back(l.weight);
    blocks.push_back(l.bias);
  }
  return blocks;
}

PoolNetwork::PoolNetwork(PoolSpec spec, std::vector<float> parameters)
    : spec_(std::move(spec)), blocks_(spec_), parameters_(std::move(parameters)) {
  const auto within = [](int n, int lo, int hi) { return n >= lo && n <= hi; };
  RequirePool(within(spec_.sets_count(), 0, kMaxSets) && within(spec_.width, 1, kMaxWidth) &&
                  within(spec_.hidden, 1, kMaxHidden) && within(spec_.outputs, 1, kMaxOutputs) &&
                  within(spec_.self, 1, kMaxInputs) && within(spec_.search, 0, kMaxInputs) &&
                  std::all_of(spec_.sets.begin(), spec_.sets.end(),
                              [&](int n) { return within(n, 1, kMaxInputs); }),
              "a size of the network is out of bounds");
  RequirePool(parameters_.size() == blocks_.size, "has another number of parameters");
  RequirePool(std::all_of(parameters_.begin(), parameters_.end(),
                          [](float x) { return std::isfinite(x) && std::abs(x) < 1e6F; }),
              "a number of the network is not finite, or not small");
}

void PoolNetwork::Pool(const PoolRows* sets, float* pooled) const {
  const int width = spec_.width;
  const float* p = parameters_.data();
  alignas(64) float first[kMaxWidth], second[kMaxWidth];
  for (int s = 0; s < spec_.sets_count(); ++s) {
    const PoolBlocks::Set& set = blocks_.sets[static_cast<std::size_t>(s)];
    float* mean = pooled + 2 * width * s;
    float* most = mean + width;
    std::copy(p + set.nobody.offset, p + set.nobody.offset + width, mean);
    std::copy(mean, mean + width, most);
    for (int r = 0; r < sets[s].count; ++r) {
      Dense(p, set.first, sets[s].rows + static_cast<std::ptrdiff_t>(r) * sets[s].stride, true,
            first);
      Dense(p, set.second, first, true, second);
      for (int k = 0; k < width; ++k) {
        mean[k] += second[k];
        most[k] = std::max(most[k], second[k]);
      }
    }
    const float share = 1.0F / static_cast<float>(sets[s].count + 1);
    for (int k = 0; k < width; ++k) mean[k] *= share;
  }
}

void PoolNetwork::Forward(const float* self, const float* search, const PoolRows* sets,
                          float* out) const {
  const float* p = parameters_.data();
  alignas(64) float joined[kMaxHidden + kMaxInputs + 2 * kMaxWidth * kMaxSets];
  alignas(64) float first[kMaxHidden], second[kMaxHidden];
  Dense(p, blocks_.self, self, true, joined);
  std::copy(search, search + spec_.search, joined + spec_.hidden);
  Pool(sets, joined + spec_.hidden + spec_.search);
  Dense(p, blocks_.trunk1, joined, true, first);
  Dense(p, blocks_.trunk2, first, true, second);
  Dense(p, blocks_.head, second, false, out);
}

}  // namespace stg::agent
