// SPDX-License-Identifier: Apache-2.0
#include "daemon/export_routes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "daemon/api.hpp"
#include "protocol/export/exports.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap {
namespace {

class ExportRoutes : public testing::Test {
 protected:
  static HttpRequest get(std::string_view target, std::string_view tag = {}) { return {"GET", target, tag}; }
  static std::string header(const HttpAnswer& answer, const std::string& name) {
    for (const auto& [key, value] : answer.headers)
      if (key == name) return value;
    return "";
  }

  std::shared_ptr<const MapSnapshot> map_ = std::make_shared<const MapSnapshot>(sample_map());
  Api api_{{[this] { return map_; }, [] { return LiveBody{}; }, [] { return ReceiverState{}; },
            [] { return PipelineStats{}; }, [] { return std::optional<Notice>{}; }},
           Config::Suit{},
           9763};
};

TEST_F(ExportRoutes, TheListNamesPathsThatAnswer) {
  const auto list = nlohmann::json::parse(*api_.http(get("/api/v1/export")).body)["exports"];
  ASSERT_EQ(list.size(), exports().size());
  for (const auto& file : list) {
    const HttpAnswer answer = api_.http(get(file["path"].get<std::string>()));
    EXPECT_EQ(answer.status, 200U) << file;
    EXPECT_EQ(header(answer, "Content-Type"), file["content_type"]);
    EXPECT_EQ(header(answer, "Content-Disposition"),
              "attachment; filename=\"" + file["name"].get<std::string>() + "\"");
    EXPECT_EQ(api_.http(get(file["path"].get<std::string>(), header(answer, "ETag"))).status, 304U) << file;
  }
  EXPECT_EQ(api_.http(get("/api/v1/export/plan.sgv")).status, 404U);
}

TEST_F(ExportRoutes, AFileIsMadeElsewhereAndOncePerMap) {
  const Reply first = api_.begin(get("/api/v1/export/plan.svg"));
  ASSERT_TRUE(first.later) << "the server's thread does not make it";
  EXPECT_EQ(first.body, nullptr);
  const Reply second = api_.begin(get("/api/v1/export/plan.svg"));
  ASSERT_TRUE(second.later);
  const SharedText body = first.later().body;
  EXPECT_EQ(body->substr(0, 4), "<svg");
  EXPECT_EQ(second.later().body, body) << "who came meanwhile gets the same";
  EXPECT_EQ(api_.begin(get("/api/v1/export/plan.svg")).body, body) << "and who comes after, at once";

  MapSnapshot next = sample_map();
  next.revision = 43;
  const Reply old = api_.begin(get("/api/v1/export/objects.csv"));
  map_ = std::make_shared<const MapSnapshot>(next);
  const Reply renewed = api_.begin(get("/api/v1/export/plan.svg"));
  ASSERT_TRUE(renewed.later);
  EXPECT_THAT(*renewed.later().body, testing::HasSubstr("map revision 43"));
  EXPECT_EQ(old.later().status, 200U) << "a map that is old by now can still be made into a file";
}

TEST_F(ExportRoutes, FilesAreNoAnswersOfTheStream) {
  EXPECT_EQ(api_.query("export/plan.svg", {}).status, 400U);
  EXPECT_EQ(api_.query("export/map.json", {}).body->substr(0, 1), "{");
}

}  // namespace
}  // namespace kinemap
