// Proves that an address is held by one camera at a time, that the holder is named, and that an
// address of another machine is refused. Does not prove that no other program listens by stealth.
#include "rig/sim/gige/address_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/rig/sim/gige/gige_bench.h"

namespace turnlight::rig::sim::gige {
namespace {

using ::testing::HasSubstr;

TEST(AddressLock, IsTakenOnceAndNamesTheHolder) {
  {
    const auto first = AddressLock::Take(OwnAddress());
    ASSERT_TRUE(first) << first.error().text;
    const auto second = AddressLock::Take(OwnAddress());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kInput);
    EXPECT_THAT(second.error().text,
                HasSubstr(OwnAddress() + ":3956: taken by process " + std::to_string(::getpid())));
    EXPECT_TRUE(AddressLock::Take(OwnAddress(1)));
  }
  EXPECT_TRUE(AddressLock::Take(OwnAddress()));
}

// A camera of another program holds no lock.
TEST(AddressLock, ACameraOfAnotherProgramIsNoticed) {
  const GigeBench bench;
  EXPECT_EQ(IsFree(bench.config.address), false);
  EXPECT_EQ(IsFree(OwnAddress(1)), true);
}

TEST(AddressLock, AnotherMachinesAddressIsRefused) {
  const auto lock = AddressLock::Take("203.0.113.7");
  ASSERT_FALSE(lock);
  EXPECT_THAT(lock.error().text, HasSubstr("203.0.113.7:3956: "));
  EXPECT_THAT(lock.error().text, HasSubstr("allowed is an address of this machine"));
}

}  // namespace
}  // namespace turnlight::rig::sim::gige
