// What the transcripts of Newport's controllers begin with: a stage that was identified.
#pragma once

#include <string>

#include "rig/serial/smc100/smc100_protocol.h"
#include "tests/rig/serial/transcript.h"

namespace turnlight::rig::serial::smc100 {

inline const std::string kSmc100Identified = R"(
  ! connect
  > 1VE
  < 1VE SMC100CC V3.1.2
  > 1TS
  < 1TS000033
  > 1ID?
  < 1IDURS100BCC
  > 1SL?
  < 1SL-170
  > 1SR?
  < 1SR170.5
  > 1VA?
  < 1VA20
  > 1AC?
  < 1AC80
  > 1SU?
  < 1SU0.0005
  > 1TE
  < 1TE@
  = identified 'Newport, SMC100CC V3.1.2, stage URS100BCC, '
  > 1TS
)";

// It has been homed and stands at 0.
inline const std::string kSmc100Ready = kSmc100Identified + R"(
  < 1TS000033
  > 1TP
  < 1TP0
  > 1TS
  < 1TS000033
  = idle 0
  .
)";

inline std::string PlaySmc100(const std::string& script, const Smc100Options& options = {}) {
  return PlayTranscript(
      [options] {
        Conversation conversation;
        conversation.protocol = std::make_unique<Smc100Protocol>(options);
        return conversation;
      },
      script);
}

}  // namespace turnlight::rig::serial::smc100
