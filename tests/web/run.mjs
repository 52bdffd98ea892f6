// SPDX-License-Identifier: Apache-2.0
// Runs a test file, or says loudly that it cannot: exit code 77.
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const needed = [
  [join(here, "node_modules/playwright-core"), "the npm packages of tests/web"],
  [join(here, "../../daemon/web/node_modules/typescript"), "the npm packages of daemon/web, with those for tests"],
  ["/usr/bin/chromium", "Chromium"],
];
for (const [path, name] of needed) {
  if (existsSync(path)) continue;
  console.log(`SKIPPED: ${name} are not here (${path}); tools/setup.sh --tests gets them`);
  process.exit(77);
}
const { status } = spawnSync(process.execPath, ["--test", join(here, process.argv[2])], { stdio: "inherit" });
process.exit(status ?? 1);
