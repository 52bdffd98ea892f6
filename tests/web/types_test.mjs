// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

test("the page's TypeScript has no type error", () => {
  const web = join(dirname(fileURLToPath(import.meta.url)), "../../daemon/web");
  const { status, stdout } = spawnSync(process.execPath, ["node_modules/typescript/bin/tsc", "--noEmit"], { cwd: web, encoding: "utf8" });
  assert.equal(status, 0, stdout);
});
