// Proves: JSON and YAML are read strictly: unknown, missing and repeated keys, wrong kinds, numbers
// out of range or not finite, and deep nesting are refused with file, line (YAML), key, value and
// what is allowed; quoted numbers stay texts. Does not prove: that the JSON and YAML libraries
// follow their standards.
#include "base/strict_object.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace turnlight {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

Document Json(const std::string& text) {
  auto document = ParseJson(text, "f.json");
  if (!document) ADD_FAILURE() << document.error().text;
  return document.value_or(Document{});
}

Document Yaml(const std::string& text) {
  auto document = ParseYaml(text, "f.yaml");
  if (!document) ADD_FAILURE() << document.error().text;
  return document.value_or(Document{});
}

std::string JsonError(const std::string& text) {
  const auto document = ParseJson(text, "f.json");
  return document ? "accepted" : document.error().text;
}

std::string YamlError(const std::string& text) {
  const auto document = ParseYaml(text, "f.yaml");
  return document ? "accepted" : document.error().text;
}

// What Finish() says after read(object) of a JSON text.
template <typename Read>
std::string Refusal(const std::string& text, Read read) {
  const Document document = Json(text);
  StrictObject object(document);
  read(object);
  const Status status = object.Finish();
  if (!status) {
    EXPECT_EQ(status.error().kind, ErrorKind::kInput);
  }
  return status ? "accepted" : status.error().text;
}

std::string NumberRefusal(const std::string& value, Range range = {}) {
  return Refusal("{\"n\": " + value + "}", [&](StrictObject& o) { o.Number("n", range); });
}

TEST(StrictObject, ReadsEveryKind) {
  const Document document = Json(R"({"n": 1.5, "i": -3, "b": true, "s": "x", "c": "two",
      "l": [1, 2.5, 3], "m": [[1, 2], [3, 4], [5, 6]], "o": {"k": 1}, "os": [{"k": 1}, {"k": 2}],
      "x-mine": 5, "skip": 6})");
  StrictObject object(document);
  EXPECT_EQ(object.Number("n"), 1.5);
  EXPECT_EQ(object.Integer("i", -5, 5), -3);
  EXPECT_TRUE(object.Boolean("b"));
  EXPECT_EQ(object.String("s"), "x");
  EXPECT_EQ(object.Choice("c", {"one", "two"}), "two");
  EXPECT_THAT(object.Numbers("l", 3), ElementsAre(1, 2.5, 3));
  EXPECT_THAT(object.Matrix("m", 3, 2), ElementsAre(1, 2, 3, 4, 5, 6));
  StrictObject nested = object.Object("o");
  EXPECT_EQ(nested.Integer("k", 0, 9), 1);
  EXPECT_TRUE(nested.Finish());
  auto list = object.Objects("os", 2);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[1].Integer("k", 0, 9), 2);
  object.AllowPrefix("x-");
  object.Ignore("skip");
  EXPECT_TRUE(object.Has("n"));
  EXPECT_FALSE(object.Has("none"));
  const Status status = object.Finish();
  EXPECT_TRUE(status) << status.error().text;
}

TEST(StrictObject, AbsentOptionals) {
  const Document document = Json("{}");
  StrictObject object(document);
  EXPECT_FALSE(object.OptionalNumber("a"));
  EXPECT_FALSE(object.OptionalInteger("a", 0, 1));
  EXPECT_FALSE(object.OptionalBoolean("a"));
  EXPECT_FALSE(object.OptionalString("a"));
  EXPECT_FALSE(object.OptionalChoice("a", {"x"}));
  EXPECT_FALSE(object.OptionalNumbers("a", 2));
  EXPECT_FALSE(object.OptionalObject("a"));
  EXPECT_TRUE(object.Raw("a").is_null());
  EXPECT_TRUE(object.Finish());
}

TEST(StrictObject, UnknownKeyNamesTheKnown) {
  EXPECT_THAT(Refusal(R"({"radius": 1, "raduis": 2})", [](StrictObject& o) { o.Number("radius"); }),
              AllOf(HasSubstr("f.json: raduis: unknown key"), HasSubstr("allowed are radius")));
  EXPECT_THAT(Refusal(R"({"y-mine": 1})", [](StrictObject& o) { o.AllowPrefix("x-"); }),
              HasSubstr("y-mine: unknown key"));
}

TEST(StrictObject, OfAMissingKeyWhatIsAllowedIsSaid) {
  struct Read {
    void (*by)(StrictObject&);
    const char* allowed;
  };
  for (const Read& read : std::vector<Read>{
           {[](StrictObject& o) { o.Number("k", {.above = 0.0}); }, "a finite number above 0"},
           {[](StrictObject& o) { o.Integer("k", 0, 1); }, "a whole number from 0 to 1"},
           {[](StrictObject& o) { o.Boolean("k"); }, "true or false"},
           {[](StrictObject& o) { o.String("k"); }, "a text"},
           {[](StrictObject& o) {
              o.Choice("k", {"a", "b"});
            },
            "one of a, b"},
           {[](StrictObject& o) { o.Numbers("k", 2); }, "a list of 2, each a finite number"},
           {[](StrictObject& o) { o.Matrix("k", 2, 3); }, "2 rows of 3 finite numbers"},
           {[](StrictObject& o) { o.Object("k"); }, "an object of keys and values"},
           {[](StrictObject& o) { o.Objects("k", 1); }, "a list of objects, at least 1"}})
    EXPECT_EQ(Refusal("{}", read.by),
              std::string("f.json: k: this key is missing, allowed is ") + read.allowed);
}

TEST(StrictObject, AMisspeltKeyIsNamedInsteadOfTheMissingOne) {
  const Document document = *ParseJson(R"({"raduis": 3, "mask": "m"})", "f.json");
  StrictObject object(document);
  object.Number("radius");
  const Status status = object.Finish();  // before anybody asked for the mask
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text, AllOf(HasSubstr("f.json: raduis: unknown key"),
                                         HasSubstr("did you mean \"radius\"?")));
}

TEST(StrictObject, WrongKind) {
  const std::string text = R"({"k": "5"})";
  const auto refusal = [&](auto read) { return Refusal(text, read); };
  EXPECT_EQ(refusal([](StrictObject& o) { o.Number("k"); }),
            "f.json: k: \"5\", allowed is a finite number");
  EXPECT_THAT(refusal([](StrictObject& o) { o.Integer("k", 0, 9); }),
              HasSubstr("a whole number from 0 to 9"));
  EXPECT_THAT(refusal([](StrictObject& o) { o.Boolean("k"); }), HasSubstr("true or false"));
  EXPECT_THAT(refusal([](StrictObject& o) {
                o.Choice("k", {"a", "b"});
              }),
              HasSubstr("\"5\", allowed is one of a, b"));
  EXPECT_THAT(refusal([](StrictObject& o) { o.Numbers("k", 2); }), HasSubstr("a list of 2"));
  EXPECT_THAT(refusal([](StrictObject& o) { o.Matrix("k", 3, 4); }),
              HasSubstr("3 rows of 4 finite numbers"));
  EXPECT_THAT(refusal([](StrictObject& o) { o.Objects("k", 0); }), HasSubstr("a list of"));
  EXPECT_THAT(Refusal(R"({"k": 5})", [](StrictObject& o) { o.String("k"); }), HasSubstr("a text"));
  EXPECT_THAT(Refusal(R"({"k": null})", [](StrictObject& o) { o.OptionalString("k"); }),
              HasSubstr("null, allowed is a text"));
  EXPECT_THAT(Refusal("[1]", [](StrictObject& o) { o.Number("k"); }),
              HasSubstr("allowed is an object"));
}

TEST(StrictObject, WrongShape) {
  EXPECT_THAT(Refusal(R"({"k": [1, 2, 3]})", [](StrictObject& o) { o.Numbers("k", 2); }),
              HasSubstr("[1,2,3], allowed is a list of 2"));
  EXPECT_THAT(Refusal(R"({"k": [1, "2"]})", [](StrictObject& o) { o.Numbers("k", 2); }),
              HasSubstr("allowed is a list of 2"));
  EXPECT_THAT(Refusal(R"({"k": [[1, 2], [3]]})", [](StrictObject& o) { o.Matrix("k", 2, 2); }),
              HasSubstr("2 rows of 2"));
  EXPECT_THAT(Refusal(R"({"k": []})", [](StrictObject& o) { o.Objects("k", 1); }),
              HasSubstr("a list of objects, at least 1"));
}

TEST(StrictObject, NumbersInRange) {
  EXPECT_EQ(NumberRefusal("0", {.min = 0.0}), "accepted");
  EXPECT_EQ(NumberRefusal("1", {.max = 1.0}), "accepted");
  EXPECT_THAT(NumberRefusal("0", {.above = 0.0}),
              HasSubstr("0, allowed is a finite number above 0"));
  EXPECT_THAT(NumberRefusal("-1", {.min = 0.0}), HasSubstr("of at least 0"));
  EXPECT_THAT(NumberRefusal("2", {.min = 0.0, .max = 1.0}), HasSubstr("of at most 1"));
  const auto integer = [](const std::string& value) {
    return Refusal("{\"i\": " + value + "}", [](StrictObject& o) { o.Integer("i", 1, 10); });
  };
  EXPECT_EQ(integer("10"), "accepted");
  for (const char* bad : {"0", "11", "1.0", "1.5", "18446744073709551615", "1e3", "true"})
    EXPECT_THAT(integer(bad), HasSubstr("a whole number from 1 to 10")) << bad;
}

TEST(StrictObject, NotFiniteNumbers) {
  EXPECT_THAT(JsonError(R"({"n": NaN})"), HasSubstr("f.json: not valid JSON"));
  EXPECT_THAT(JsonError(R"({"n": 1e999})"), HasSubstr("f.json: not valid JSON"));
  for (const char* bad : {".nan", ".inf", "-.inf", "nan", "inf", "1e999"}) {
    const Document document = Yaml("n: " + std::string(bad));
    StrictObject object(document);
    object.Number("n");
    EXPECT_THAT(object.Finish().error().text, HasSubstr("f.yaml:1: n: \"" + std::string(bad)));
  }
}

TEST(StrictObject, FirstRefusalIsKept) {
  EXPECT_THAT(Refusal(R"({"a": -1, "b": -1})",
                      [](StrictObject& o) {
                        EXPECT_EQ(o.Number("b", {.min = 0.0}), 0.0);
                        EXPECT_FALSE(o.ok());
                        o.Number("a", {.min = 0.0});
                      }),
              HasSubstr("f.json: b: -1"));
  EXPECT_EQ(Refusal(R"({"a": 7})", [](StrictObject& o) { o.RefuseText("a", "is odd"); }),
            "f.json: a: is odd");
}

TEST(StrictObject, NestedPlacesAreNamed) {
  const Document document = Json(R"({"frames": [{"n": 1}, {"n": "x"}]})");
  StrictObject object(document);
  auto frames = object.Objects("frames", 1);
  frames[1].Number("n");
  EXPECT_THAT(frames[1].Finish().error().text, HasSubstr("f.json: frames/1/n: \"x\""));
  EXPECT_TRUE(frames[0].ok());
}

TEST(StrictObject, LongValuesAreCut) {
  const std::string text = NumberRefusal("\"" + std::string(1000, 'x') + "\"");
  EXPECT_LT(text.size(), 200u);
  EXPECT_THAT(text, HasSubstr("..."));
}

TEST(ParseJson, Refusals) {
  EXPECT_THAT(JsonError("{\n\"a\": }"),
              StartsWith("f.json: not valid JSON: parse error at line 2"));
  EXPECT_THAT(JsonError(""), HasSubstr("not valid JSON"));
  EXPECT_THAT(JsonError("{} x"), HasSubstr("not valid JSON"));
  EXPECT_THAT(JsonError("{\"a\": \"\xff\"}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(JsonError(R"({"a": 1, "b": 2, "a": 1})"), HasSubstr("\"a\" appears twice"));
  EXPECT_THAT(JsonError(R"({"o": [{"a": 1, "a": 1}]})"), HasSubstr("\"a\" appears twice"));
  EXPECT_EQ(JsonError(R"({"a": {"k": 1}, "b": {"k": 1}})"), "accepted");
}

TEST(ParseJson, Depth) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_EQ(JsonError(nested(32)), "accepted");
  EXPECT_THAT(JsonError(nested(33)), HasSubstr("more than 32 levels"));
  EXPECT_THAT(JsonError(std::string(10000000, '[')), HasSubstr("more than 32 levels"));
  EXPECT_EQ(JsonError("\"" + std::string(100, '[') + "\\\"" + std::string(100, '[') + "\""),
            "accepted");
}

TEST(ParseYaml, ScalarsByTheirLook) {
  const Document document = Yaml(
      "i: 5\np: +5\nn: 1.5\ne: 1e-3\nz: 010\nq: '5'\nd: \"1.5\"\nt: !!str 7\nb: true\nu: null\n"
      "v: 0x10\nw: 1.2.3\nbig: 12345678901234567890\n");
  const auto& root = document.root;
  EXPECT_EQ(root["i"], 5);
  EXPECT_EQ(root["p"], 5);
  EXPECT_TRUE(root["i"].is_number_integer());
  EXPECT_EQ(root["n"], 1.5);
  EXPECT_EQ(root["e"], 1e-3);
  EXPECT_EQ(root["z"], 10);
  EXPECT_EQ(root["q"], "5");
  EXPECT_EQ(root["d"], "1.5");
  EXPECT_EQ(root["t"], "7");
  EXPECT_EQ(root["b"], true);
  EXPECT_TRUE(root["u"].is_null());
  EXPECT_EQ(root["v"], "0x10");
  EXPECT_EQ(root["w"], "1.2.3");
  EXPECT_EQ(root["big"], 12345678901234567890.0);
}

TEST(ParseYaml, LinesInMessages) {
  const Document document = Yaml("# a comment\nname: x\nlights:\n  - power: 1\n  - power: -1\n");
  StrictObject object(document);
  auto lights = object.Objects("lights", 1);
  lights[1].Number("power", {.min = 0.0});
  EXPECT_EQ(lights[1].Finish().error().text,
            "f.yaml:5: lights/1/power: -1, allowed is a finite number of at least 0");
  // A missing key is reported at the line of its object.
  lights[0].Number("none");
  EXPECT_EQ(lights[0].Finish().error().text,
            "f.yaml:4: lights/0/none: this key is missing, allowed is a finite number");
  EXPECT_EQ(object.Finish().error().text.substr(0, 14), "f.yaml:2: name");
  // A key with keys below it is reported at its own line.
  const Document nested = Yaml("a: 1\nlihgts:\n  power: 1\n");
  StrictObject root(nested);
  root.OptionalNumber("a");
  EXPECT_EQ(root.Finish().error().text, "f.yaml:2: lihgts: unknown key, allowed are a");
}

TEST(ParseYaml, Refusals) {
  EXPECT_THAT(YamlError("a: 1\nb: [1, 2\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(YamlError("a: 1\nb: 2\na: 3\n"),
              AllOf(HasSubstr("f.yaml:3"), HasSubstr("\"a\" appears twice")));
  EXPECT_THAT(YamlError("? [1, 2]\n: 3\n"), HasSubstr("a key must be a word"));
  EXPECT_THAT(YamlError("a: 1\n---\nb: 2\n"), HasSubstr("2 documents, allowed is 1"));
  EXPECT_THAT(YamlError("a: *none\n"), HasSubstr("not valid YAML"));
  EXPECT_EQ(YamlError(""), "accepted");
  const Document empty = Yaml("");
  EXPECT_THAT(StrictObject(empty).Finish().error().text, HasSubstr("null, allowed is an object"));
}

TEST(ParseYaml, Depth) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_EQ(YamlError(nested(32)), "accepted");
  EXPECT_THAT(YamlError(nested(40)), HasSubstr("more than 32 levels"));
  EXPECT_THAT(YamlError(std::string(100000, '[')), HasSubstr("not valid YAML"));
}

// Each level doubles the one before: 2^30 values in 700 bytes.
TEST(ParseYaml, AliasesDoNotExplode) {
  std::string text = "a0: &a0 [1, 2]\n";
  for (int i = 1; i < 30; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before + ", " + before +
            "]\n";
  }
  EXPECT_THAT(YamlError(text), HasSubstr("more than 100000 values"));
  EXPECT_THAT(YamlError("&a [*a]"), HasSubstr("f.yaml"));
}

}  // namespace
}  // namespace turnlight
