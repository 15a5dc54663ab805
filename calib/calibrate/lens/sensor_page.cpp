#include "calib/calibrate/lens/sensor_page.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace turnlight::calib::calibrate::lens {
namespace {

constexpr int kLeft = 76, kBelow = 74, kBarRoom = 96;
constexpr double kMaxWidth = 760.0, kMaxHeight = 620.0;

std::vector<plot::Tick> PixelTicks(int size) {
  std::vector<plot::Tick> ticks;
  const int step = std::max(1, static_cast<int>(plot::RoundUp(size / 6.0)));
  for (int at = 0; at <= size; at += step)
    ticks.push_back({static_cast<double>(at) / size, std::to_string(at)});
  return ticks;
}

}  // namespace

SensorPage MakeSensorPage(int width, int height, const std::string& title, const std::string& below,
                          bool bar) {
  SensorPage sensor;
  sensor.scale = std::min(kMaxWidth / width, kMaxHeight / height);
  sensor.area = {kLeft, plot::kTitleHeight, std::max(1, static_cast<int>(width * sensor.scale)),
                 std::max(1, static_cast<int>(height * sensor.scale))};
  const int words =
      std::max(plot::TextWidth(title, plot::kCaption), plot::TextWidth(below, plot::kLabel));
  const int right = bar ? kBarRoom : 0;
  sensor.page = plot::Page(kLeft + std::max(sensor.area.width, words) + right + plot::kMargin,
                           plot::kTitleHeight + sensor.area.height + kBelow);
  plot::DrawTitle(sensor.page, kLeft, title);
  plot::Place(sensor.page, sensor.page(sensor.area).clone(), sensor.area.tl());
  plot::DrawTicksBelow(sensor.page, sensor.area, PixelTicks(width));
  plot::DrawTicksLeft(sensor.page, sensor.area, PixelTicks(height));
  plot::DrawTextUpwards(sensor.page, "pixel", {18.0, sensor.area.y + 0.5 * sensor.area.height},
                        plot::kLabel);
  plot::DrawText(sensor.page, below, {double(kLeft), sensor.area.y + sensor.area.height + 50.0},
                 plot::kLabel, plot::Align::kLeft);
  return sensor;
}

void DrawLogMap(SensorPage& sensor, const ImageGrid& grid, const std::vector<double>& values,
                const std::string& unit) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const double value : values)
    if (std::isfinite(value) && value > 0.0) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  if (!(high > 0.0)) return;
  const plot::LogAxis axis = plot::LogAxisAround(std::max(low, 1e-4 * high), high);
  cv::Mat3b map(sensor.area.size());
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const double column = (x + 0.5) / map.cols * (grid.columns - 1);
      const double row = (y + 0.5) / map.rows * (grid.rows - 1);
      const int c = std::min(static_cast<int>(column), grid.columns - 2);
      const int r = std::min(static_cast<int>(row), grid.rows - 2);
      const double u = column - c, v = row - r;
      const auto at = [&](int i, int j) {
        return values[static_cast<std::size_t>((r + j) * grid.columns + c + i)];
      };
      const double value =
          (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
      map(y, x) =
          plot::SequentialColour(std::isfinite(value) ? 1.0 - axis.At(std::max(value, 1e-300))
                                                      : std::numeric_limits<double>::quiet_NaN());
    }
  plot::Place(sensor.page, map, sensor.area.tl());
  std::vector<plot::Tick> ticks = plot::LogTicks(axis);
  for (plot::Tick& tick : ticks) tick.at = 1.0 - tick.at;  // of a bar they count from below
  plot::DrawScaleBeside(sensor.page, sensor.area, plot::SequentialColour, ticks, unit);
}

}  // namespace turnlight::calib::calibrate::lens
