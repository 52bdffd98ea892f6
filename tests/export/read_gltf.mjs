// SPDX-License-Identifier: Apache-2.0
// scene.glb held against glTF 2.0 by Khronos's own validator.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";

if (!existsSync(new URL("node_modules/gltf-validator", import.meta.url))) {
  console.log("SKIPPED: the npm packages of tests/export are not here; tools/setup.sh --tests gets them");
  process.exit(77);
}
const { default: validator } = await import("gltf-validator");

async function checked(folder, remarks) {
  const bytes = new Uint8Array(readFileSync(join(process.argv[2], folder, "scene.glb")));
  const report = await validator.validateBytes(bytes, { uri: "scene.glb" });
  assert.deepEqual(report.issues.messages.map(({ code }) => code), remarks, JSON.stringify(report.issues, null, 1));
  assert.equal(report.mimeType, "model/gltf-binary");
  const length = new DataView(bytes.buffer).getUint32(12, true);
  return { report, json: JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length))) };
}

const { report, json } = await checked("sample", []);
const map = JSON.parse(readFileSync(join(process.argv[2], "sample/map.json"), "utf8"));
for (const object of map.objects) {
  const nodes = json.nodes.filter((node) => node.name === `${object.type} ${object.id}`);
  assert.equal(nodes.length, 1, `one node for ${object.type} ${object.id}`);
  assert.deepEqual(nodes[0].extras, object, "the object's JSON: type, functions, size, …");
  assert.notEqual(nodes[0].mesh, undefined);
}
assert.equal(report.info.drawCallCount, map.objects.length + map.rooms.length + 1);
const empty = await checked("empty", ["NODE_EMPTY"]);
assert.equal(empty.report.info.drawCallCount, 0);
console.log(`scene.glb: ${report.info.totalVertexCount} vertices, nothing to object to`);
