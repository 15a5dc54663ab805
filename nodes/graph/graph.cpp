#include "nodes/graph/graph.h"

#include <exception>
#include <utility>

#include "base/format.h"
#include "base/nearest.h"
#include "nodes/graph/connect.h"
#include "nodes/graph/executor.h"
#include "nodes/graph/log.h"
#include "nodes/graph/replay.h"

namespace turnlight::nodes::graph {
namespace {

Result<std::unique_ptr<Node>> MakeNode(const NodeConfig& config, const NodeRegistry& registry) {
  const NodeRegistry::Factory* factory = registry.Find(config.type);
  if (!factory)
    return InputError(config.where + ": there is no node type \"" + config.type +
                      "\", allowed are " + Listed(registry.Types()) +
                      DidYouMean(config.type, registry.Types()));
  std::unique_ptr<Node> node;
  std::string problem = "its factory returned nothing";
  try {
    node = (*factory)();
  } catch (const std::exception& exception) {
    problem = exception.what();
  }
  if (!node) return InputError(config.where + ": a " + config.type + " cannot be made: " + problem);
  return node;
}

// Opens the log and hangs it on the recorded topics. Null if there is none to write.
Result<std::shared_ptr<LogWriter>> AttachLog(GraphParts& parts, const std::filesystem::path& path) {
  if (path.empty()) return std::shared_ptr<LogWriter>();
  LogHeader header{parts.config.hash, parts.config.seed, {}};
  for (const OutputPort* port : parts.recorded)
    header.topics.push_back({port->Topic(), port->type.name, port->type.version});
  auto writer = LogWriter::Create(path, header);
  if (!writer) return Forward(writer);
  const std::shared_ptr<LogWriter> log = std::move(*writer);
  std::uint16_t topic = 0;
  for (OutputPort* port : parts.recorded) {
    const MessageType& type = port->type;
    AddTap(*port,
           [log, &type, topic](const AnyMessage& message) { log->Append(topic, type, message); });
    ++topic;
  }
  return log;
}

RunReport CloseLog(RunEnd end, LogWriter* log) {
  if (!log) return std::move(end.report);
  const Status status = log->Close(end.stop);
  if (!status && !end.report.failure) {
    end.report.failure = Fault{"graph", "log", status.error().text, false};
    end.report.faults.push_back(*end.report.failure);
    ++end.report.fault_count;
    end.report.cause = StopCause::kFault;
  }
  return std::move(end.report);
}

}  // namespace

Result<Graph> Graph::Build(GraphConfig config, const NodeRegistry& registry) {
  auto parts = std::make_shared<GraphParts>();
  for (const NodeConfig& node_config : config.nodes) {
    auto node = MakeNode(node_config, registry);
    if (!node) return Forward(node);
    NodeCore& core = (*node)->core();
    core.node = node->get();
    core.name = node_config.name;
    core.type = node_config.type;
    core.index = parts->nodes.size();
    core.seed = config.seed;
    core.duration = node_config.duration;
    core.deadline = node_config.deadline;
    parts->nodes.push_back(std::move(*node));
  }
  parts->config = std::move(config);
  if (Status status = Connect(*parts); !status) return Forward(status);
  return Graph(std::move(parts));
}

Status Graph::Configure() { return ConfigureNodes(true); }

Status Graph::ConfigureNodes(bool sources_too) {
  if (parts_->configured) return {};
  for (std::size_t i = 0; i < parts_->nodes.size(); ++i) {
    const NodeCore& core = parts_->core(i);
    if (core.is_source && !sources_too) continue;
    StrictObject params = parts_->config.nodes[i].params;
    const auto fault =
        Guarded(core, "configure", "", [&] { return parts_->nodes[i]->Configure(params); });
    if (Status status = params.Finish(); !status) return status;
    if (fault) return InputError(parts_->config.nodes[i].where + ": " + fault->text);
  }
  parts_->configured = true;
  return {};
}

Result<RunReport> Graph::Run(const RunOptions& options) {
  if (std::exchange(parts_->ran, true)) return InputError("a graph runs once; build another");
  if (Status status = Configure(); !status) return Forward(status);
  auto log = AttachLog(*parts_, options.log);
  if (!log) return Forward(log);
  RunEnd end = parts_->config.executor == ExecutorKind::kWall
                   ? RunWall(parts_, options, *log)
                   : RunVirtual(*parts_, options, log->get(), nullptr);
  return CloseLog(std::move(end), log->get());
}

Result<RunReport> Graph::Replay(const std::filesystem::path& path, const RunOptions& options) {
  if (std::exchange(parts_->ran, true)) return InputError("a graph runs once; build another");
  auto reader = LogReader::Open(path);
  if (!reader) return Forward(reader);
  auto plan = PlanReplay(*parts_, *reader, path.string());
  if (!plan) return Forward(plan);
  if (Status status = ConfigureNodes(false); !status) return Forward(status);
  auto log = AttachLog(*parts_, options.log);
  if (!log) return Forward(log);
  return CloseLog(RunVirtual(*parts_, options, log->get(), &*plan), log->get());
}

void Graph::RaiseStop(GraphParts& parts, StopMode mode) {
  const int wanted = mode == StopMode::kNow ? 2 : 1;
  int level = parts.stop_level.load(std::memory_order_relaxed);
  while (level < wanted && !parts.stop_level.compare_exchange_weak(level, wanted)) {
  }
}

Result<OutputPort*> Graph::FindOutput(const std::string& topic) const {
  std::vector<std::string> topics;
  for (const auto& node : parts_->nodes)
    for (OutputPort* port : node->core().outputs) {
      if (port->Topic() == topic) return port;
      topics.push_back(port->Topic());
    }
  return InputError("there is no topic \"" + topic + "\", allowed are " + Listed(topics) +
                    DidYouMean(topic, topics));
}

}  // namespace turnlight::nodes::graph
