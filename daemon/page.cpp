// SPDX-License-Identifier: Apache-2.0
#include "daemon/page.hpp"

namespace kinemap {
namespace {

constexpr const char* kPage = R"html(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Kinemap</title>
<style>
 body { font: 15px system-ui, sans-serif; margin: 1.5em; color: #222; max-width: 70em }
 h1 { font-size: 1.3em } #health { padding: .4em .8em; border-radius: .3em; background: #eee; display: inline-block }
 #health.ok { background: #d5f0d5 } #health.refused { background: #f6cfcf } #health.waiting { background: #f6ebc8 }
 svg { width: 100%; height: 60vh; border: 1px solid #ccc; background: #fafafa; margin-top: 1em }
 .wall { stroke: #333; fill: none } .table { fill: #c9a26a } .screen { stroke: #2468c0; fill: none } .chair { fill: #4a9a5a }
 .room { fill: #eef3fa; stroke: none } .wearer { fill: #d03030 } .path { fill: none; stroke: #d03030; opacity: .35 }
 text { fill: #555 }
</style></head><body>
<h1>Kinemap</h1>
<p id="health">…</p>
<p id="numbers"></p>
<svg id="plan" role="img" aria-label="floor plan"></svg>
<p>Data: <a href="api/v1/map">map</a> · <a href="api/v1/objects">objects</a> · <a href="api/v1/trajectory">trajectory</a> ·
<a href="api/v1/pose">pose</a> · <a href="api/v1/status">status</a></p>
<script>
"use strict";
const get = async (path) => (await fetch(path)).json();
const plan = document.getElementById("plan");
function draw(parent, name, attributes, text) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  parent.appendChild(node);
}
// The plan is seen from above, north up: y is turned over.
const points = (list) => list.map((p) => p[0] + "," + -p[1]).join(" ");
function show(map, trajectory, pose) {
  plan.replaceChildren();
  const path = trajectory.poses.map((p) => p.position), all = [...path];
  for (const room of map.rooms) {
    draw(plan, "polygon", {class: "room", points: points(room.polygon)});
    all.push(...room.polygon);
  }
  draw(plan, "polyline", {class: "path", points: points(path), "stroke-width": 0.03});
  // Seen from above: what stands on a table is drawn after it.
  for (const o of map.objects.sort((a, b) => (b.type === "table") - (a.type === "table"))) {
    const at = o.pose.position;
    if (o.corners) {
      draw(plan, "polygon", {class: o.type, points: points(o.corners), "stroke-width": 0.06});
      all.push(...o.corners);
    } else draw(plan, "circle", {class: o.type, cx: at[0], cy: -at[1], r: 0.22});
    draw(plan, "text", {x: at[0], y: -at[1], "font-size": 0.22}, o.type + " " + o.id);
    all.push(at);
  }
  if (pose && pose.position) {
    draw(plan, "circle", {class: "wearer", cx: pose.position[0], cy: -pose.position[1], r: 0.15});
    all.push(pose.position);
  }
  const xs = all.map((p) => p[0]), ys = all.map((p) => -p[1]);
  const low = (v) => v.reduce((a, b) => Math.min(a, b), 0) - 1, high = (v) => v.reduce((a, b) => Math.max(a, b), 0) + 1;
  plan.setAttribute("viewBox", [low(xs), low(ys), high(xs) - low(xs), high(ys) - low(ys)].join(" "));
}
let map, trajectory;
async function refresh() {
  const health = document.getElementById("health");
  try {
    const h = await get("healthz"), s = await get("api/v1/status"), pose = await get("api/v1/pose");
    health.className = h.status;
    health.textContent = h.status + ": " + h.message;
    const n = s.map.objects;
    document.getElementById("numbers").textContent = `${s.suit.rate_hz || 0} Hz · ${s.tracker.frames} frames · ` +
      `${s.tracker.path_m} m walked · ${n.wall} walls, ${n.table} tables, ${n.screen} screens, ${n.chair} chairs · ` +
      `${s.map.loop_closures} loops closed · map revision ${s.map.revision}`;
    if (!map || map.revision !== s.map.revision) [map, trajectory] = [await get("api/v1/map"), await get("api/v1/trajectory")];
    show(map, trajectory, pose);
  } catch (error) {
    health.className = "refused";
    health.textContent = "kinemapd does not answer: " + error.message;
  }
  setTimeout(refresh, 1000);
}
refresh();
</script></body></html>
)html";

}  // namespace

void add_page_routes(Routes& routes) {
  const auto text = std::make_shared<const std::string>(kPage);
  const char* type = "text/html; charset=utf-8";
  routes.add({.path = "/", .summary = "The live page.", .content_type = type, .answer = [text, type](const Call&) {
                return Reply{.content_type = type, .body = text};
              }});
}

}  // namespace kinemap
