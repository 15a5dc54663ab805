// A camera driver as docs/drivers.md adds one: pictures come from the PNG files of a folder, in the
// order of their names, one for each trigger. Keys: path, size ([width, height]).
#pragma once

#include "base/result.h"
#include "base/strict_object.h"
#include "rig/driver.h"

namespace turnlight::app {

Result<rig::CameraDevice> MakeFolderCamera(StrictObject keys);

}  // namespace turnlight::app
