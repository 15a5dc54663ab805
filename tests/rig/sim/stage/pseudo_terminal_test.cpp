// Proves that a pseudo-terminal carries any byte both ways, tells whether it is open, and that the
// fixed link takes nobody else's name. Does not prove the pace of a serial line (stage_simulator).
#include "rig/sim/stage/pseudo_terminal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/rig/sim/stage/port_client.h"

namespace turnlight::rig::sim::stage {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string AllBytes() {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  return bytes;
}

TEST(PseudoTerminal, CarriesEveryByteBothWays) {
  auto terminal = PseudoTerminal::Open();
  ASSERT_TRUE(terminal) << terminal.error().text;
  EXPECT_FALSE(terminal->HasClient());
  PortClient client(terminal->name());
  ASSERT_TRUE(client.IsOpen());
  EXPECT_TRUE(terminal->HasClient());
  const std::string bytes = AllBytes();
  ASSERT_TRUE(client.Write(bytes));
  terminal->WaitForInput(1000);
  EXPECT_EQ(terminal->Read(1000), bytes);
  EXPECT_EQ(terminal->Write(bytes + "end"), bytes.size() + 3);
  EXPECT_EQ(client.ReadUntil("end"), bytes + "end");
}

TEST(PseudoTerminal, WhatNobodyReadIsLostForTheNextClient) {
  auto terminal = PseudoTerminal::Open();
  ASSERT_TRUE(terminal);
  { PortClient first(terminal->name()), second(std::move(first)); }
  EXPECT_FALSE(terminal->HasClient());
  terminal->Write("old\n");
  {
    PortClient client(terminal->name());
    client.Write("last words\n");
  }
  EXPECT_FALSE(terminal->HasClient());
  EXPECT_EQ(terminal->Read(1000), "last words\n");  // a closed port's words are still read
  terminal->DiscardOutput();
  PortClient client(terminal->name());
  terminal->Write("new\n");
  EXPECT_EQ(client.ReadUntil("\n"), "new\n");
}

TEST(PseudoTerminal, ComesBackUnderAnotherNameAndHangsUp) {
  auto first = PseudoTerminal::Open();
  ASSERT_TRUE(first);
  const std::string name = first->name();
  PortClient client(name);
  { const PseudoTerminal gone = std::move(*first); }
  EXPECT_TRUE(client.SeesHangUp());
  const auto second = PseudoTerminal::Open(name);
  ASSERT_TRUE(second);
  EXPECT_NE(second->name(), name);
}

TEST(PortLink, IsReplacedInOneStepAndTakesNobodyElsesName) {
  const PortFolder folder;
  const fs::path link = folder / "deep/er/port";
  ASSERT_TRUE(PointPortLink(link, "/dev/pts/900"));
  ASSERT_TRUE(PointPortLink(link, "/dev/pts/901"));
  EXPECT_EQ(fs::read_symlink(link), "/dev/pts/901");
  RemovePortLink(link, "/dev/pts/900");  // another's by now
  EXPECT_TRUE(fs::is_symlink(link));
  RemovePortLink(link, "/dev/pts/901");
  EXPECT_FALSE(fs::is_symlink(link));
  EXPECT_TRUE(fs::is_empty(folder / "deep/er"));

  std::ofstream(folder / "file") << "mine";
  EXPECT_THAT(PointPortLink(folder / "file", "/dev/pts/900").error().text,
              HasSubstr("there is something else under this name"));
  fs::create_symlink("/etc/hostname", folder / "other");
  EXPECT_FALSE(PointPortLink(folder / "other", "/dev/pts/900"));
  EXPECT_EQ(fs::read_symlink(folder / "other"), "/etc/hostname");
}

}  // namespace
}  // namespace turnlight::rig::sim::stage
