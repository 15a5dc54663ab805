// SHA-256 as lower-case hexadecimal, by OpenSSL.
#pragma once

#include <string>
#include <string_view>

namespace turnlight {

std::string Sha256Hex(std::string_view bytes);

}  // namespace turnlight
