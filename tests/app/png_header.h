// PNG files that no writer makes.
#pragma once

#include <cstdint>
#include <string>

namespace turnlight::app {

// The same file with another size in its header, the header's checksum made right again.
std::string WithPngSize(std::string png, std::uint32_t width, std::uint32_t height);

// A picture of 8 bits with an alpha channel.
std::string RgbaPng(int width, int height);

}  // namespace turnlight::app
