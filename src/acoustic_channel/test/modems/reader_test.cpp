#include "acoustic_channel/s2c/reader.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace stg::acoustics::s2c {
namespace {

ByteView Bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// The items that a reader finds in a text that comes in pieces of these lengths. Pieces of data
/// are joined.
std::vector<std::string> Items(const std::string& text, Reader::Mode mode,
                               const std::vector<std::size_t>& pieces) {
  Reader reader;
  reader.SetMode(mode);
  std::vector<std::string> items;
  bool data = false;
  std::size_t at = 0;
  for (std::size_t k = 0; at < text.size(); ++k) {
    const std::size_t length = k < pieces.size() ? pieces[k] : text.size() - at;
    reader.Feed(Bytes(text.substr(at, length)));
    at += length;
    while (const auto item = reader.Next()) {
      const bool is_data = item->kind == Item::Kind::kData;
      if (is_data && data) {
        items.back() += item->payload;
        continue;
      }
      data = is_data;
      static const char* kNames[] = {"command ", "message ", "data ", "broken ", "too long "};
      items.push_back(kNames[static_cast<int>(item->kind)] + std::string(item->escaped ? "+" : "") +
                      item->text + (item->payload.empty() ? "" : "|" + item->payload));
    }
  }
  return items;
}

std::vector<std::string> Items(const std::string& text, Reader::Mode mode = Reader::Mode::kPlain) {
  return Items(text, mode, {});
}

using Lines = std::vector<std::string>;

TEST(S2cReader, LinesEndAsHostsEndThem) {
  EXPECT_EQ(Items("AT?S\nAT!L1\r\n\r\nAT?AL\rAT?T\n"),
            (Lines{"command ?S", "command !L1", "command ?AL", "command ?T"}));
}

TEST(S2cReader, PayloadsAreFramedByTheirLength) {
  EXPECT_EQ(Items("AT*SENDIM,5,2,ack,a\r\n,b\nAT?S\n"),
            (Lines{"message *SENDIM,5,2,ack|a\r\n,b", "command ?S"}));
  EXPECT_EQ(Items("AT*SENDIM,p7,2,2,ack,hi\nAT*SENDIMS,2,3,,hi\nAT*SENDPBM,1,2,x\r\n"),
            (Lines{"message *SENDIM,p7,2,2,ack|hi", "message *SENDIMS,2,3,|hi",
                   "message *SENDPBM,1,2|x"}));
}

TEST(S2cReader, AWrongLengthCostsOneLine) {
  EXPECT_EQ(Items("AT*SENDIM,2,2,ack,hello\nAT?S\n"), (Lines{"broken *SENDIM", "command ?S"}));
  EXPECT_EQ(Items("AT*SENDIM,x,2,ack,hello\nAT?S\n"), (Lines{"broken *SENDIM", "command ?S"}));
  EXPECT_EQ(Items("AT*SENDIM,9999,2,ack,hello\nAT?S\n"), (Lines{"too long *SENDIM", "command ?S"}));
  EXPECT_EQ(Items("AT*SENDIM,2,2\nAT?S\n"), (Lines{"broken *SENDIM", "command ?S"}));
}

TEST(S2cReader, ALineWithoutEndIsBrokenOnce) {
  const std::string line(20'000, 'x');
  EXPECT_EQ(Items(line + "\nAT?S\n"), (Lines{"broken ", "command ?S"}));
}

TEST(S2cReader, DataModeKnowsCommandsByTheirEscape) {
  EXPECT_EQ(Items("raw\r\n+++AT?S\nmore++data", Reader::Mode::kData),
            (Lines{"data |raw\r\n", "command +?S", "data |more++data"}));
  EXPECT_EQ(Items("+++AT*SENDIM,3,2,noack,+++\n", Reader::Mode::kData),
            (Lines{"message +*SENDIM,3,2,noack|+++"}));
}

TEST(S2cReader, NoSplitOfTheStreamChangesWhatIsRead) {
  const std::string plain =
      "AT?S\r\nAT*SENDIM,5,2,ack,a\r\nb,\nAT*SENDIM,9,2,ack,short\nxx\nAT!L9\r" +
      std::string(5000, 'y') + "\r\nAT*SENDIMS,p1,3,4,,a+b\r\n+++AT?S\nAT*SENDPBM,,2,x\nAT\n\n" +
      "AT*SENDIM," + std::string(300, '1') + "\nAT*SENDIM,2000,1,ack,zz\nAT?CLOCK\n";
  const std::string data = "raw+++\r\n+++AT?S\r\n++++AT!L3\n" + plain + "+++ATO\n+++++A";
  std::mt19937 random(5);
  for (const Reader::Mode mode : {Reader::Mode::kPlain, Reader::Mode::kData}) {
    const std::string& text = mode == Reader::Mode::kPlain ? plain : data;
    const Lines whole = Items(text, mode);
    EXPECT_GT(whole.size(), 8u);
    EXPECT_EQ(Items(text, mode, std::vector<std::size_t>(text.size(), 1)), whole);
    for (int draw = 0; draw < 200; ++draw) {
      std::vector<std::size_t> pieces;
      for (std::size_t k = 0; k < text.size(); ++k) pieces.push_back(1 + random() % 40);
      EXPECT_EQ(Items(text, mode, pieces), whole);
    }
  }
}

TEST(S2cReader, ALonelyEscapeNeedsSilence) {
  Reader reader;
  reader.SetMode(Reader::Mode::kData);
  reader.Feed(Bytes("+++"));
  EXPECT_FALSE(reader.Next());
  EXPECT_TRUE(reader.awaits_silence());
  EXPECT_TRUE(reader.OnSilence());
  EXPECT_FALSE(reader.awaits_silence());
}

}  // namespace
}  // namespace stg::acoustics::s2c
