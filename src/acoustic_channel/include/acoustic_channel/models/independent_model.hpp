#pragma once

#include <memory>

#include "acoustic_channel/models/independent_links.hpp"
#include "acoustic_channel/models/propagation_model.hpp"

namespace stg::acoustics {

/// Quality by the formula of a model of independent links.
template <class Formula>
class FormulaEstimator : public LinkEstimator {
 public:
  explicit FormulaEstimator(const Formula& formula) : formula_(formula) {}
  double Quality(double d, double age_s, double /*learnt*/) const override {
    return formula_.At(d, age_s).quality;
  }
  Pack Quality(const Pack& d, const Pack& age_s, const Pack& /*learnt*/) const override {
    return formula_.At(d, age_s).quality;
  }
  double freshness_s() const override { return formula_.freshness_s(); }

 private:
  Formula formula_;
};

/// A propagation model that is one formula of distance and age; see IndependentLinks for what
/// Formula must have.
template <class Formula>
class IndependentModel : public PropagationModel {
 public:
  explicit IndependentModel(const Formula& formula) : formula_(formula) {}
  std::unique_ptr<Channel> MakeChannel(const ChannelConfig& config, const RunConfig& run,
                                       LineOfSight /*line_of_sight*/) const override {
    return std::make_unique<IndependentLinks<Formula>>(formula_, config, run);
  }
  std::unique_ptr<LinkEstimator> MakeLinkEstimator(const ChannelConfig& /*config*/,
                                                   int /*nodes*/) const override {
    return std::make_unique<FormulaEstimator<Formula>>(formula_);
  }

 private:
  Formula formula_;
};

/// For a formula that is made from the section.
template <class Formula>
std::unique_ptr<PropagationModel> MakeIndependentModel(const ChannelConfig& config) {
  return std::make_unique<IndependentModel<Formula>>(Formula(config));
}

/// For a formula with options of its own.
template <class Formula, class Options>
std::unique_ptr<PropagationModel> MakeIndependentModel(const Options& options,
                                                       const ChannelConfig& config) {
  return std::make_unique<IndependentModel<Formula>>(Formula(options, config));
}

}  // namespace stg::acoustics
