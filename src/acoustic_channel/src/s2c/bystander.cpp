#include "acoustic_channel/s2c/bystander.hpp"

namespace stg::acoustics::s2c {

Bystander::Bystander(bool net) {
  reader_.SetMode(net ? Reader::Mode::kPlain : Reader::Mode::kData);
}

std::string Bystander::Read(ByteView bytes) {
  reader_.Feed(bytes);
  std::string answers;
  while (const std::optional<Item> item = reader_.Next()) {
    if (item->kind == Item::Kind::kData) continue;  // the data is dropped
    const bool fits = !item->escaped || reader_.mode() == Reader::Mode::kData;
    takes_control_ = fits && item->kind == Item::Kind::kCommand && item->text == "@CTRL";
    if (takes_control_) break;
    answers += Framed(reader_.mode(), NameOf(item->text), "ERROR NO CONTROL");
  }
  return answers;
}

std::string Bystander::Overheard(const std::string& notification) const {
  return Framed(reader_.mode(), "", notification);
}

}  // namespace stg::acoustics::s2c
