// SPDX-License-Identifier: Apache-2.0
// Bundles the live page into the folder given (CMake says which), and writes page_files.cpp there, with which the daemon carries it.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdir, readFile, rm, writeFile } from "node:fs/promises";
import { basename, dirname, extname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
if (!process.argv[2]) {
  console.error("usage: node build.mjs OUT_DIR");
  process.exit(2);
}
const out = resolve(process.argv[2]);
await rm(join(out, "assets"), { recursive: true, force: true });
await mkdir(join(out, "assets"), { recursive: true });

// Files are named by their content, so that browsers keep them for ever. three.js comes in a file of its own, loaded when the 3-D view is
// wanted: on a slow link the plan is there first.
const { metafile } = await build({
  absWorkingDir: here,
  entryPoints: { app: "src/main.tsx", style: "src/style.css", icon: "src/icon.svg" },
  outdir: join(out, "assets"),
  bundle: true,
  splitting: true,
  format: "esm",
  target: ["chrome123", "firefox120", "safari17.5"],
  jsx: "automatic",
  jsxImportSource: "preact",
  loader: { ".woff2": "file", ".svg": "copy" },
  entryNames: "[name]-[hash]",
  chunkNames: "[name]-[hash]",
  assetNames: "[name]-[hash]",
  minify: true,
  legalComments: "none", // licenses.txt has them whole
  metafile: true,
  logLevel: "warning",
});
const assets = Object.keys(metafile.outputs).map((path) => basename(path)).sort();

/** The licence texts of the packages of which something is in the bundle. */
async function licenses() {
  const names = Object.keys(metafile.inputs).flatMap((input) => /^node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(input)?.[1] ?? []);
  const texts = [...new Set(names)].sort().map(async (name) => {
    const folder = join(here, "node_modules", name);
    const { version } = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
    return `${name} ${version}\n\n${(await readFile(join(folder, "LICENSE"), "utf8")).trim()}\n`;
  });
  return (await Promise.all(texts)).join(`\n${"-".repeat(80)}\n\n`);
}

/** index.html with the names that the files got. */
async function index() {
  const named = (match, name, extension) => `assets/${assets.find((asset) => asset.startsWith(`${name}-`) && asset.endsWith(extension))}`;
  return (await readFile(join(here, "src/index.html"), "utf8")).replace(/(app|style|icon)(\.\w+)(?=")/g, named);
}

await writeFile(join(out, "index.html"), await index());
await writeFile(join(out, "licenses.txt"), await licenses());

const types = {
  ".css": "text/css; charset=utf-8",
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".svg": "image/svg+xml",
  ".txt": "text/plain; charset=utf-8",
  ".woff2": "font/woff2",
};
const files = [
  { path: "/", file: "index.html" },
  { path: "/licenses.txt", file: "licenses.txt" },
  ...assets.map((asset) => ({ path: `/assets/${asset}`, file: `assets/${asset}`, kept: true })),
];
const symbols = files.map(
  ({ file }, i) => `kinemap_page_${i}: .incbin "${join(out, file)}"\nkinemap_page_${i}_end: .byte 0`,
);
const externs = files.map((_, i) => `extern "C" const char kinemap_page_${i}[], kinemap_page_${i}_end[];`);
const rows = files.map(
  ({ path, file, kept }, i) =>
    `      {"${path}", "${types[extname(file)]}", {kinemap_page_${i}, static_cast<std::size_t>(kinemap_page_${i}_end - kinemap_page_${i})}, ${kept ?? false}},`,
);
// A digest of the contents makes the file differ whenever what it includes does, so that it is compiled again.
const digest = createHash("sha256");
for (const { file } of files) digest.update(await readFile(join(out, file)));
await writeFile(
  join(out, "page_files.cpp"),
  `// Written by daemon/web/build.mjs. ${digest.digest("hex")}
#include <array>

#include "daemon/page_files.hpp"

asm(R"(.pushsection .rodata
${symbols.join("\n")}
.popsection)");
${externs.join("\n")}

namespace kinemap {

std::span<const PageFile> page_files() {
  static const std::array<PageFile, ${files.length}> files{{
${rows.join("\n")}
  }};
  return files;
}

}  // namespace kinemap
`,
);
