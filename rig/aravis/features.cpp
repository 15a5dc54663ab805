#include "rig/aravis/features.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace turnlight::rig::aravis {

template <typename F>
auto Features::Ask(const std::string& name, F call) -> Result<decltype(call(nullptr))> {
  using Value = decltype(call(nullptr));
  if (lost_) return DeviceError(name + ": the camera does not answer");
  Failure failure;
  const auto fail = [&]() {
    lost_ = lost_ || failure.IsLoss();
    return DeviceError(name + ": " + failure.text());
  };
  if constexpr (std::is_void_v<Value>) {
    call(failure.out());
    if (failure) return fail();
    return {};
  } else {
    const Value value = call(failure.out());
    if (failure) return fail();
    return value;
  }
}

bool Features::Exists(const std::string& name) {
  ArvGcNode* node = Node(name);
  if (!ARV_IS_GC_FEATURE_NODE(node)) return false;
  return Ask(name, [&](GError** error) {
           return arv_gc_feature_node_is_implemented(ARV_GC_FEATURE_NODE(node), error);
         }).value_or(FALSE) != FALSE;
}

bool Features::Has(const std::string& name) {
  ArvGcNode* node = Node(name);
  if (!ARV_IS_GC_FEATURE_NODE(node)) return false;
  return Ask(name, [&](GError** error) {
           return arv_gc_feature_node_is_available(ARV_GC_FEATURE_NODE(node), error);
         }).value_or(FALSE) != FALSE;
}

std::string Features::FirstOf(std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (Has(name)) return name;
  return "";
}

bool Features::IsFloat(const std::string& name) { return ARV_IS_GC_FLOAT(Node(name)); }

std::string Features::Unit(const std::string& name) {
  ArvGcNode* node = Node(name);
  const char* unit = nullptr;
  if (ARV_IS_GC_FLOAT(node)) unit = arv_gc_float_get_unit(ARV_GC_FLOAT(node));
  if (ARV_IS_GC_INTEGER(node)) unit = arv_gc_integer_get_unit(ARV_GC_INTEGER(node));
  return unit ? unit : "";
}

Result<double> Features::Number(const std::string& name) {
  ArvGcNode* node = Node(name);
  if (ARV_IS_GC_FLOAT(node))
    return Ask(name,
               [&](GError** error) { return arv_gc_float_get_value(ARV_GC_FLOAT(node), error); });
  const auto value = Integer(name);
  if (!value) return Forward(value);
  return static_cast<double>(*value);
}

Result<std::int64_t> Features::Integer(const std::string& name) {
  ArvGcNode* node = Node(name);
  if (!ARV_IS_GC_INTEGER(node))
    return DeviceError(name + ": this camera has no number of that name");
  return Ask(name, [&](GError** error) -> std::int64_t {
    return arv_gc_integer_get_value(ARV_GC_INTEGER(node), error);
  });
}

Result<NumberBounds> Features::Bounds(const std::string& name) {
  ArvGcNode* node = Node(name);
  if (!ARV_IS_GC_FLOAT(node) && !ARV_IS_GC_INTEGER(node))
    return DeviceError(name + ": this camera has no number of that name");
  const auto ask = [&](auto of_float, auto of_integer) {
    return Ask(name, [&](GError** error) -> double {
      return ARV_IS_GC_FLOAT(node) ? of_float(ARV_GC_FLOAT(node), error)
                                   : static_cast<double>(of_integer(ARV_GC_INTEGER(node), error));
    });
  };
  const auto min = ask(arv_gc_float_get_min, arv_gc_integer_get_min);
  if (!min) return Forward(min);
  const auto max = ask(arv_gc_float_get_max, arv_gc_integer_get_max);
  if (!max) return Forward(max);
  return NumberBounds{*min, *max};
}

Status Features::SetNumber(const std::string& name, double value) {
  ArvGcNode* node = Node(name);
  if (ARV_IS_GC_FLOAT(node))
    return Ask(name,
               [&](GError** error) { arv_gc_float_set_value(ARV_GC_FLOAT(node), value, error); });
  if (!ARV_IS_GC_INTEGER(node))
    return DeviceError(name + ": this camera has no number of that name");
  return Ask(name, [&](GError** error) {
    arv_gc_integer_set_value(ARV_GC_INTEGER(node), std::llround(value), error);
  });
}

Result<std::string> Features::Word(const std::string& name) {
  ArvGcNode* node = Node(name);
  if (!ARV_IS_GC_FEATURE_NODE(node)) return DeviceError(name + ": this camera has none");
  const auto text = Ask(name, [&](GError** error) {
    return arv_gc_feature_node_get_value_as_string(ARV_GC_FEATURE_NODE(node), error);
  });
  if (!text) return Forward(text);
  return std::string(*text ? *text : "");
}

std::vector<std::string> Features::Words(const std::string& name) {
  if (!ARV_IS_GC_ENUMERATION(Node(name))) return {};
  Failure failure;
  guint count = 0;
  const std::unique_ptr<const char*, Free> words(
      arv_device_dup_available_enumeration_feature_values_as_strings(device_, name.c_str(), &count,
                                                                     failure.out()));
  lost_ = lost_ || failure.IsLoss();
  if (!words) return {};
  return {words.get(), words.get() + count};
}

bool Features::Allows(const std::string& name, const std::string& word) {
  const auto words = Words(name);
  return std::find(words.begin(), words.end(), word) != words.end();
}

Status Features::SetWord(const std::string& name, const std::string& word) {
  const Status set = Ask(name, [&](GError** error) {
    arv_device_set_string_feature_value(device_, name.c_str(), word.c_str(), error);
  });
  if (!set) return set;
  const auto now = Word(name);
  if (!now) return Forward(now);
  if (*now == word) return {};
  return DeviceError(name + ": was set to " + word + ", the camera has " + *now);
}

Result<bool> Features::IsOff(const std::string& name) {
  ArvGcNode* node = Node(name);
  if (ARV_IS_GC_ENUMERATION(node)) {
    const auto word = Word(name);
    if (!word) return Forward(word);
    return *word == "Off";
  }
  if (ARV_IS_GC_BOOLEAN(node)) {
    const auto on = Ask(name, [&](GError** error) {
      return arv_gc_boolean_get_value(ARV_GC_BOOLEAN(node), error);
    });
    if (!on) return Forward(on);
    return *on == FALSE;
  }
  const auto number = Number(name);
  if (!number) return Forward(number);
  return *number == 0.0;
}

Status Features::SwitchOff(const std::string& name) {
  if (IsOff(name).value_or(false)) return {};  // it may be one that can only be read
  ArvGcNode* node = Node(name);
  Status set;
  if (ARV_IS_GC_ENUMERATION(node)) {
    set = SetWord(name, "Off");
  } else if (ARV_IS_GC_BOOLEAN(node)) {
    set = Ask(name, [&](GError** error) {
      arv_gc_boolean_set_value(ARV_GC_BOOLEAN(node), FALSE, error);
    });
  } else {
    set = SetNumber(name, 0.0);
  }
  if (!set) return DeviceError(set.error().text + "; it must be off");
  const auto off = IsOff(name);
  if (!off) return Forward(off);
  return *off ? Status() : Status(DeviceError(name + ": cannot be switched off"));
}

Status Features::Execute(const std::string& name) {
  return Ask(name,
             [&](GError** error) { arv_device_execute_command(device_, name.c_str(), error); });
}

Result<std::uint32_t> Features::Register(std::uint64_t address) {
  return Ask("register " + Format("0x%llx", static_cast<unsigned long long>(address)),
             [&](GError** error) -> std::uint32_t {
               guint32 value = 0;
               arv_device_read_register(device_, address, &value, error);
               return value;
             });
}

}  // namespace turnlight::rig::aravis
