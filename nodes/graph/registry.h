// The node types that a config may name. The composition root fills one of these, line by line;
// nothing registers itself.
//   NodeRegistry registry;
//   registry.Add<Threshold>("threshold");
//   registry.Add("camera", [&rig] { return std::make_unique<CameraNode>(rig.camera()); });
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nodes/graph/node.h"

namespace turnlight::nodes::graph {

class NodeRegistry {
 public:
  using Factory = std::function<std::unique_ptr<Node>()>;

  // A later factory of the same name replaces the earlier: tests put mocks in place.
  void Add(std::string type, Factory factory) { factories_[std::move(type)] = std::move(factory); }
  template <typename N>
  void Add(std::string type) {
    Add(std::move(type), [] { return std::make_unique<N>(); });
  }

  // Null if there is no such type.
  const Factory* Find(const std::string& type) const {
    const auto found = factories_.find(type);
    return found == factories_.end() ? nullptr : &found->second;
  }
  std::vector<std::string> Types() const {
    std::vector<std::string> types;
    for (const auto& entry : factories_) types.push_back(entry.first);
    return types;
  }

 private:
  std::map<std::string, Factory> factories_;
};

}  // namespace turnlight::nodes::graph
