#include "app/calibrate/board_pictures.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "app/calibrate/picture_files.h"
#include "app/progress.h"
#include "calib/calibrate/board/detect_boards.h"
#include "calib/calibrate/board/shown_board.h"
#include "rig/session/raw_capture.h"

namespace turnlight::app {
namespace {

namespace fs = std::filesystem;
namespace boards = calib::calibrate::board;

struct Source {
  std::string name;
  std::function<Result<GreyPicture>()> read;
};

Result<GreyPicture> ReadGreyFrame(const rig::RawCapture& capture, std::size_t frame) {
  const auto picture = rig::ReadRawImage(capture, frame);
  if (!picture) return Forward(picture);
  GreyPicture grey{*picture, {}};
  if (picture->channels() == 3) cv::cvtColor(*picture, grey.grey, cv::COLOR_RGB2GRAY);
  return grey;
}

Result<std::vector<Source>> SourcesOf(const std::vector<std::string>& arguments) {
  std::vector<Source> sources;
  std::vector<std::string> files;
  for (const std::string& argument : arguments) {
    if (!rig::IsRawCapture(argument)) {
      files.push_back(argument);
      continue;
    }
    auto read = rig::ReadRawCapture(argument);
    if (!read) return Forward(read);
    const auto capture = std::make_shared<const rig::RawCapture>(std::move(*read));
    std::vector<std::size_t> frames = rig::FramesOfKind(*capture, "board");
    if (frames.empty())
      for (std::size_t i = 0; i < capture->frames.size(); ++i) frames.push_back(i);
    for (const std::size_t frame : frames)
      sources.push_back({(fs::path(argument) / capture->frames[frame].image).string(),
                         [capture, frame] { return ReadGreyFrame(*capture, frame); }});
  }
  if (!files.empty() || sources.empty()) {
    const auto paths = ListPictures(files);
    if (!paths) return Forward(paths);
    for (const fs::path& path : *paths)
      sources.push_back({path.string(), [path] { return ReadGreyPicture(path); }});
  }
  return sources;
}

std::string Joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += (text.empty() ? "" : "; ") + sentence;
  return text;
}

}  // namespace

Result<BoardPictures> FindBoardsInPictures(const std::vector<std::string>& arguments,
                                           const boards::Board& board) {
  const auto sources = SourcesOf(arguments);
  if (!sources) return Forward(sources);
  const std::size_t count = sources->size();
  std::vector<cv::Size> sizes(count);
  std::vector<std::vector<std::string>> remarks(count);
  std::vector<Result<boards::Detection>> found;
  {
    Progress progress("finding the board", count);
    found = boards::DetectInPictures(
        count,
        [&](std::size_t i) -> Result<cv::Mat> {
          const auto picture = (*sources)[i].read();
          if (!picture) return Forward(picture);
          sizes[i] = picture->grey.size();
          remarks[i] = picture->remarks;
          return picture->grey;
        },
        board, [&progress](std::size_t) { progress.Step(); });
  }
  std::vector<std::string> names;
  for (const Source& source : *sources) names.push_back(source.name);
  if (const Status status = boards::CheckShownBoard(names, found, board); !status)
    return Forward(status);
  const CommonSize common = FindCommonSize(sizes);
  BoardPictures result;
  for (std::size_t i = 0; i < count; ++i) {
    const cv::Size size = sizes[i].empty() ? common.size : sizes[i];
    calib::calibrate::lens::PictureViews views{(*sources)[i].name, size.width, size.height, {}, ""};
    if (found[i]) {
      for (const boards::DetectedBoard& one : found[i]->boards) {
        views.boards.push_back(one.view);
        remarks[i].insert(remarks[i].end(), one.remarks.begin(), one.remarks.end());
      }
      const bool none = found[i]->boards.empty();
      if (none)
        views.why_none = Joined(found[i]->remarks);
      else
        remarks[i].insert(remarks[i].end(), found[i]->remarks.begin(), found[i]->remarks.end());
    } else {
      views.why_none = found[i].error().text;
    }
    if (!remarks[i].empty()) result.remarks.push_back(views.picture + ": " + Joined(remarks[i]));
    result.views.push_back(std::move(views));
  }
  return result;
}

}  // namespace turnlight::app
