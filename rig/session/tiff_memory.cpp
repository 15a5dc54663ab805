#include "rig/session/tiff_memory.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace turnlight::rig {
namespace {

TiffMemory& MemoryOf(thandle_t handle) { return *static_cast<TiffMemory*>(handle); }

tmsize_t ReadBytes(thandle_t handle, void* buffer, tmsize_t count) {
  TiffMemory& memory = MemoryOf(handle);
  if (count <= 0 || memory.position >= memory.bytes.size()) return 0;
  const std::size_t n =
      std::min(static_cast<std::size_t>(count), memory.bytes.size() - memory.position);
  std::memcpy(buffer, memory.bytes.data() + memory.position, n);
  memory.position += n;
  return static_cast<tmsize_t>(n);
}

tmsize_t WriteBytes(thandle_t handle, void* buffer, tmsize_t count) {
  TiffMemory& memory = MemoryOf(handle);
  const std::size_t end = memory.position + static_cast<std::size_t>(count);
  if (end > memory.bytes.size()) memory.bytes.resize(end, '\0');
  std::memcpy(memory.bytes.data() + memory.position, buffer, static_cast<std::size_t>(count));
  memory.position = end;
  return count;
}

toff_t Seek(thandle_t handle, toff_t offset, int whence) {
  TiffMemory& memory = MemoryOf(handle);
  const std::size_t base = whence == SEEK_SET   ? 0
                           : whence == SEEK_CUR ? memory.position
                                                : memory.bytes.size();
  memory.position = base + offset;
  return memory.position;
}

int Close(thandle_t) { return 0; }
toff_t Size(thandle_t handle) { return MemoryOf(handle).bytes.size(); }

int KeepComplaint(TIFF*, void* user_data, const char*, const char* format, va_list arguments) {
  TiffMemory& memory = MemoryOf(user_data);
  char text[256];
  std::vsnprintf(text, sizeof text, format, arguments);
  if (memory.complaint.empty()) memory.complaint = text;
  return 1;
}
int Silence(TIFF*, void*, const char*, const char*, va_list) { return 1; }

}  // namespace

TiffHandle OpenTiff(TiffMemory& memory, const char* mode) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  // A hostile directory may ask for any amount; nothing we read needs more than the file and a row.
  TIFFOpenOptionsSetMaxSingleMemAlloc(
      options, static_cast<tmsize_t>(memory.bytes.size()) + (tmsize_t{1} << 26));
  TIFFOpenOptionsSetErrorHandlerExtR(options, KeepComplaint, &memory);
  TIFFOpenOptionsSetWarningHandlerExtR(options, Silence, nullptr);
  TIFF* tiff = TIFFClientOpenExt("", mode, &memory, ReadBytes, WriteBytes, Seek, Close, Size,
                                 nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  return {tiff, TIFFClose};
}

tl::unexpected<Error> DamagedTiff(const std::string& file, const TiffMemory& memory) {
  return InputError(file + ": damaged or truncated TIFF: " + memory.complaint);
}

}  // namespace turnlight::rig
