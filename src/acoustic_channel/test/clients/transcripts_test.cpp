#include <algorithm>

#include "modems/modem_fixture.hpp"

/// Replays what third-party clients wrote to emulated modems, byte for byte and at their times, and
/// checks what they must hear. modems.launch command_log:=FILE recorded it. docs/modems.md names
/// the versions.
namespace stg::acoustics {
namespace {

/// Bytes of a client: time, host, bytes.
struct Spoken {
  double t_s;
  int host;
  std::string bytes;
};

void Replay(ModemBench* bench, const std::vector<Spoken>& words) {
  for (const Spoken& word : words) bench->Say(word.host, word.t_s, word.bytes);
  bench->water->Advance(Ns(words.back().t_s + 30.0));
}

/// Expects that the text has these parts in this order.
void ExpectInOrder(const std::string& text, const std::vector<std::string>& parts) {
  std::size_t at = 0;
  for (const std::string& part : parts) {
    const std::size_t found = text.find(part, at);
    ASSERT_NE(found, std::string::npos) << part << " after " << at << " of\n" << text;
    at = found + part.size();
  }
}

TEST(Transcripts, SignetsBurstTransmitterAndReceiver) {
  ModemBench bench(2);
  bench.StartS2c();
  Replay(&bench, {{1.0, 1, "ATZ4\n"},
                  {4.2, 0, "ATZ4\n"},
                  {4.7, 0, "AT*SENDIM,18,2,noack,CIAO CIAO0        \n"},
                  {7.7, 0, "AT*SENDIM,18,2,noack,CIAO CIAO1        \n"},
                  {10.7, 0, "AT*SENDIM,18,2,ack,CIAO CIAO2        \n"},
                  {23.7, 0, "AT?T\n"}});
  EXPECT_EQ(bench.hosts.all[0], "OK\r\nOK\r\nOK\r\nOK\r\nDELIVEREDIM,2\r\n1000000\r\n");
  ExpectInOrder(bench.hosts.all[1],
                {"OK\r\n", "RECVIM,18,1,2,noack,349500,", ",0.0000,CIAO CIAO0        \r\n",
                 "CIAO CIAO1        \r\n", "RECVIM,18,1,2,ack,", "CIAO CIAO2        \r\n"});
}

/// dune's task Transports/Evologics: its start, and messages with line ends in them. It does not
/// wait for answers to the first three commands.
TEST(Transcripts, Dune) {
  ModemBench bench(2);
  bench.medium->SetDelay(0, 1, 0.664975);  // 1000 m; dune waits 2 s for an acknowledgement
  bench.StartS2c();
  std::vector<Spoken> words = {{5.0, 0, "ATZ1\nATZ3\nATZ4\n"}};
  double t_s = 7.0;
  for (const char* word : {"?MODE", "I0", "I1", "@CTRL", "!AL1", "!L3", "!G0", "!RC3", "!RT2000",
                           "!RI0", "!ZI0", "!AM254", "@ZU1", "!RP1", "!C2", "@ZX1"}) {
    words.push_back({t_s += 0.01, 0, "AT" + std::string(word) + "\n"});
  }
  words.insert(words.end(), {{20.0, 0, "AT*SENDIM,5,2,noack,B\r\nBB\n"},
                             {32.0, 0, "AT*SENDIM,8,2,ack,C\r\nCCCCC\n"},
                             {36.0, 0, "AT?T\n"},
                             {36.1, 0, "AT?P\n"},
                             {40.0, 0, "AT?CLOCK\n"}});
  Replay(&bench, words);
  ExpectInOrder(bench.hosts.all[0],
                {"NET\r\n1.9\r\nphy: emulated 0.1, mac: emulated v1.9\r\n",
                 "OK\r\nOK\r\n[*]OK\r\n[*]OK\r\nOK\r\n[*]OK\r\n[*]OK\r\nOK\r\nOK\r\nOK\r\n",
                 "[*]OK\r\n[*]OK\r\nOK\r\n", "OK\r\nSENDSTART,2,im,206500,0\r\n",
                 "SENDEND,2,im,20000000,206500\r\n", "SENDSTART,2,im,239500,0\r\n",
                 "RECVSTART\r\nRECVEND,", "DELIVEREDIM,2\r\n664975\r\n",
                 "0 100\n0 0\n0 0\n0 0\n0 0\n0 0\n0 0\n0 0\n\r\n", "40000000\r\n"});
  ExpectInOrder(bench.hosts.all[1], {"RECVIM,5,1,2,noack,206500,", ",0.0000,B\r\nBB\r\n",
                                     "RECVIM,8,1,2,ack,239500,", ",0.0000,C\r\nCCCCC\r\n"});
}

TEST(Transcripts, Evins) {
  ModemBench bench(2);
  bench.StartS2c(s2c::ModemOptions());  // AT interpreters
  std::vector<Spoken> words;
  double t_s = 10.188;
  for (const char* word : {"?MODE", "?AL", "?AM", "?PID", "@ZF1", "@ZX1", "@ZU1", "@ZA1"}) {
    for (const int host : {0, 1}) {
      words.push_back({t_s, host, "+++AT" + std::string(word) + "\n"});
    }
    t_s += 0.008;
  }
  words.insert(words.end(), {{17.734, 0, "+++AT?S\n"},
                             {19.739, 0, "+++AT*SENDIM,p0,6,2,noack,to two\n"},
                             {22.741, 0, "+++AT*SENDIM,p0,5,2,ack,hello\n"},
                             {28.764, 0, "+++AT?T\n"},
                             {30.760, 0, "+++AT*SENDIM,p0,6,255,noack,to all\n"},
                             {33.771, 0, "+++AT!L9\n"},
                             {35.786, 0, "+++AT*SENDIM,p0,6,77,ack,unsent\n"},
                             {49.786, 0, "+++AT*SEND,p0,15,2,a burst of data\n"},
                             {63.789, 0, "+++AT*SENDPBM,p0,5,2,rides\n"},
                             {65.795, 0, "+++AT*SENDIMS,p0,3,2,,now\n"},
                             {69.803, 0, "+++ATZ3\n"}});
  Replay(&bench, words);
  // The parser of the client needs OK to all settings of the start, and four fields of RECVEND.
  ExpectInOrder(bench.hosts.all[0], {"+++AT?MODE:2:AT\r\n",
                                     "+++AT?AL:1:1\r\n",
                                     "+++AT?AM:3:254\r\n",
                                     "+++AT?PID:1:0\r\n",
                                     "+++AT@ZF:2:OK\r\n",
                                     "+++AT@ZX:2:OK\r\n",
                                     "+++AT@ZU:2:OK\r\n",
                                     "+++AT@ZA:2:OK\r\n",
                                     "+++AT?S:17:INITIATION LISTEN",
                                     "+++AT*SENDIM:2:OK\r\n",
                                     ":SENDSTART,2,im,217500,0\r\n",
                                     ":SENDEND,2,im,19739000,217500\r\n",
                                     ":RECVSTART\r\n",
                                     ":RECVEND,24967500,162500,-130,508\r\n",
                                     "+++AT:13:DELIVEREDIM,2\r\n",
                                     "+++AT?T:7:1000000\r\n",
                                     "SENDSTART,255,im,",
                                     "+++AT!L:18:ERROR OUT OF RANGE\r\n",
                                     "+++AT:11:FAILEDIM,77\r\n",
                                     "+++AT*SEND:2:OK\r\n",
                                     "+++AT:7:RADDR,2\r\n",
                                     "+++AT:18:BITRATE,local,6900\r\n",
                                     "+++AT:13:DELIVERED,1,2\r\n",
                                     "+++AT*SENDPBM:2:OK\r\n",
                                     "+++AT*SENDIMS:2:OK\r\n",
                                     "SENDEND,2,ims,65795000,",
                                     "+++ATZ3:2:OK\r\n",
                                     "+++AT:13:CANCELEDPBM,2\r\n"});
  ExpectInOrder(bench.hosts.all[1],
                {"RECVIM,p0,6,1,2,noack,217500,-130,508,0.0000,to two\r\n",
                 "RECVIM,p0,5,1,2,ack,206500,-130,508,0.0000,hello\r\n", "RECVIM,p0,6,1,255,noack,",
                 "RADDR,1\r\n", "RECV,p0,15,1,2,6900,-130,508,1000000,0.0000,a burst of data\r\n",
                 "RECVIMS,p0,3,1,2,66795000,184500,-130,508,0.0000,now\r\n"});
}

TEST(Transcripts, Pyacomms) {
  ModemBench bench(2);
  bench.StartMicromodems();
  // The modems of the client had the addresses 3 and 4.
  Replay(&bench, {{5.0, 0, "$CCCFG,SRC,3*33\r\n"},
                  {5.0, 1, "$CCCFG,SRC,4*34\r\n"},
                  {6.0, 0, "$CCCFQ,SRC*3A\r\n"},
                  {7.1, 1, "$CCCFQ,SRC*3A\r\n"},
                  {8.1, 0, "$CCCFG,DTO,8*25\r\n"},
                  {8.3, 0, "$CCCFQ,DTO*27\r\n"},
                  {8.5, 0, "$CCMPC,3,4*59\r\n"},
                  {13.0, 0, "$CCCYC,0,3,4,1,0,3*5C\r\n"},
                  {13.1, 0, "$CCTXD,3,4,0,000001006b072b33*7D\r\n"},
                  {13.2, 0, "$CCTXD,3,4,0,000001006b072b33*7D\r\n"},
                  {13.3, 0, "$CCTXD,3,4,0,000001006b072b33*7D\r\n"},
                  {20.0, 0, "$CCCYC,0,3,4,1,0,1*5E\r\n"},
                  {20.1, 0, "$CCTXD,3,4,1,68656c6c6f2066726f6d20707961636f6d6d73*7B\r\n"},
                  {30.0, 0, "$CCCYC,0,3,4,0,0,1*5F\r\n"},
                  {31.5, 0, "$CCTXD,3,4,0,66736b206672616d65*7E\r\n"},
                  {40.0, 0, "$CCXYZ,1*00\r\n"}});
  ExpectInOrder(bench.hosts.all[0], {"$CACFG,SRC,3*31\r\n",
                                     "$CACFG,DTO,8*27\r\n",
                                     "$CACFG,DTO,8*27\r\n",
                                     "$CAMPC,3,4*5B\r\n",
                                     "$CATXP,2*40\r\n",
                                     "$CATXF,2*56\r\n",
                                     "$CARXP,0*44\r\n",
                                     "$CAMPR,4,3,1.0000*",
                                     "$CACST,6,0,",
                                     "$CACYC,0,3,4,1,0,3*5E\r\n",
                                     "$CADRQ,",
                                     "$CATXD,3,4,0,8*45\r\n",
                                     "$CADRQ,",
                                     "$CATXD,3,4,0,8*45\r\n",
                                     "$CADRQ,",
                                     "$CATXD,3,4,0,8*45\r\n",
                                     "$CATXP,24*74\r\n",
                                     "$CATXF,24*62\r\n",
                                     "$CAXST,6,",
                                     "$CATXD,3,4,1,19*74\r\n",
                                     "$CAACK,4,3,1,1*4C\r\n",
                                     "$CACST,6,0,",
                                     "$CACYC,0,3,4,0,0,1*5D\r\n",
                                     "$CATXP,2*40\r\n",
                                     "$CATXF,2*56\r\n",
                                     "$CADRQ,",
                                     "$CATXD,3,4,0,9*44\r\n",
                                     "$CATXF,9*5D\r\n",
                                     "$CAERR,",
                                     ",NMEA,1,bad checksum*"});
  ExpectInOrder(bench.hosts.all[1],
                {"$CACFG,SRC,4*36\r\n", "$CARXP,0*44\r\n", "$CAMPA,3,4*59\r\n", "$CACST,6,0,",
                 "$CARXD,3,4,0,1,000001006B072B33*64\r\n", "$CARXD,3,4,0,3,", "$CACST,6,0,",
                 "$CARXD,3,4,1,1,68656C6C6F2066726F6D20707961636F6D6D73*62\r\n", "$CACST,6,0,",
                 "$CATXP,2*40\r\n", "$CARXD,3,4,0,1,66736B206672616D65*67\r\n"});
}

/// The program goby_test_mmdriver1 uses Micromodems-2 like this: a ping, a frame at rate 0, three
/// frames at rate 2, flexible data. Its own frames were longer.
TEST(Transcripts, Goby) {
  ModemBench bench(2);
  bench.StartMicromodems();
  std::vector<Spoken> words;
  for (const int host : {0, 1}) {
    const std::string source = "$CCCFG,SRC," + std::string(host == 0 ? "1*31" : "2*32");
    const std::string boot = "$CCMSC," + std::string(host == 0 ? "1,1" : "2,2") + ",0*41";
    double t_s = 9.0;
    for (const std::string& word :
         {std::string("$CCCFG,ALL,0*33"), std::string("$CCCFG,CST,1*37"),
          std::string("$CCCFG,AGC,0*37"), std::string("$CCCFG,AGN,0*3A"),
          std::string("$CCCFG,psk.packet.mod_hdr_version,0*70"), source,
          std::string("$CCCFG,REV,1*32"), std::string("$CCCFG,RXP,1*29"), boot}) {
      words.push_back({t_s += 0.1, host, word + "\r\n"});
    }
    // This falls into the reboot, so it comes again.
    words.push_back({10.1, host, "$CCCFQ,SRC*3A\r\n"});
    words.push_back({15.1, host, "$CCCFQ,SRC*3A\r\n"});
    words.push_back({15.3, host, "$CCTMS,2026-11-26T11:05:35Z,0*75\r\n"});
    words.push_back({15.4, host, "$CCCFQ,TOP*33\r\n"});
  }
  words.insert(words.end(),
               {{29.700, 0, "$CCTMQ,0*54\r\n"},
                {32.731, 0, "$CCMPC,1,2*5D\r\n"},
                {38.114, 0, "$CCCYC,0,1,2,0,1,1*5A\r\n"},
                {39.033, 0, "$CCTXD,1,2,1,0001020304*7E\r\n"},
                {46.766, 0, "$CCCYC,0,1,2,2,1,3*5A\r\n"},
                {46.768, 0, "$CCTXD,1,2,1,404142*7D\r\n"},
                {46.872, 0, "$CCTXD,1,2,1,808182*71\r\n"},
                {46.973, 0, "$CCTXD,1,2,1,c0c1c2*2A\r\n"},
                {54.492, 1, "$CCCFG,psk.packet.mod_hdr_version,1*71\r\n"},
                {54.698, 1, "$CCTDP,1,1,0,0,00112233445566778899001122334455667788990011*6C\r\n"}});
  std::stable_sort(words.begin(), words.end(),
                   [](const Spoken& a, const Spoken& b) { return a.t_s < b.t_s; });
  Replay(&bench, words);
  ExpectInOrder(bench.hosts.all[0],
                {"$CACFG,ALL,0*31\r\n",
                 "$CACFG,psk.packet.mod_hdr_version,0*72\r\n",
                 "$CACFG,SRC,1*33\r\n",
                 "$CAMSC,1,1,0*43\r\n",
                 "$CAREV,",
                 ",INIT,2.0.35490*",
                 ",AUV,2.0.35490*",
                 "$CACFG,SRC,1*33\r\n",
                 "$CATMS,0,2026-11-26T11:05:35Z*77\r\n",
                 "$CATMQ,2026-11-26T11:05:49Z,",
                 "$CAMPC,1,2*5F\r\n",
                 "$CAMPR,2,1,1.0000*",
                 "$CACST,6,0,",
                 "$CACYC,0,1,2,0,1,1*58\r\n",
                 "$CATXP,2*40\r\n",
                 "$CAXST,6,",
                 "$CADRQ,",
                 "$CATXD,1,2,1,5*",
                 "$CAXST,6,",
                 "$CAACK,2,1,1,1*",
                 "$CACST,6,0,",
                 "$CACYC,0,1,2,2,1,3*58\r\n",
                 "$CADRQ,",
                 "$CADRQ,",
                 "$CADRQ,",
                 "$CAXST,6,",
                 "$CAACK,2,1,1,1*",
                 "$CAACK,2,1,2,1*",
                 "$CAACK,2,1,3,1*",
                 "$CACST,6,0,",
                 "$CARDP,2,1,1,0,0,,1;22;00112233445566778899001122334455667788990011*",
                 "$CACST,6,0,"});
  ExpectInOrder(bench.hosts.all[1],
                {"$CAMPA,1,2*", "$CACST,6,0,", "$CACYC,0,1,2,0,1,1*", "$CACST,6,0,",
                 "$CARXD,1,2,1,1,0001020304*", "$CACST,6,0,", "$CACYC,0,1,2,2,1,3*",
                 "$CARXD,1,2,1,1,404142*", "$CARXD,1,2,1,2,808182*", "$CARXD,1,2,1,3,C0C1C2*",
                 "$CACST,6,0,", "$CATDP,0,1,1,1,0,0*", "$CAXST,6,"});
}

}  // namespace
}  // namespace stg::acoustics
