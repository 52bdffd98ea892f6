// SPDX-License-Identifier: Apache-2.0
// session.mcap, read by MCAP's own reader: whole, and cut short.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";

import { McapIndexedReader, McapStreamReader } from "@mcap/core";

import { checkOwnSchema, checkSchema, Daemon, idsOf, jsonOf, run, temporaryFolder, Viewer } from "./support.mjs";

let folder;
before(async () => {
  folder = temporaryFolder();
  await run("kinemap", "sim", "--seed", "3", "--rooms", "1", "--rounds", "1", "--out", folder);
  const input = join(folder, "session.pcap");
  await run("kinemap", "build", input, "--out", join(folder, "body"), "--body-hz", "5");
  await run("kinemap", "build", input, "--out", join(folder, "key-poses"));
});

const file = (name) => readFileSync(join(folder, name));
const mapOf = (name) => JSON.parse(file(join(name, "map.json")));

/** Reads by index, checks every message, and returns them by topic: [{ time, message }]. */
async function readIndexed(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  assert.equal(reader.header.library, "kinemap");
  const byTopic = {};
  let count = 0n;
  for await (const { channelId, logTime, data } of reader.readMessages()) {
    const channel = reader.channelsById.get(channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    assert.equal(channel.messageEncoding, "json");
    assert.equal(schema.encoding, "jsonschema");
    const message = jsonOf(data);
    checkSchema(schema.name, message);
    checkOwnSchema(new TextDecoder().decode(schema.data), message);
    (byTopic[channel.topic] ??= []).push({ time: Number(logTime) / 1e9, message });
    ++count;
  }
  assert.equal(count, reader.statistics.messageCount);
  return byTopic;
}

/** How many messages a stream reader finds before the bytes end; checksums are checked. */
function countStreamed(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true });
  reader.append(bytes);
  let count = 0;
  for (let record; (record = reader.nextRecord()); ) count += record.type === "Message";
  return { count, done: reader.done() };
}

/** The scene at the end. */
function lastScene(byTopic) {
  const viewer = new Viewer();
  for (const { message } of byTopic["/map/scene"]) viewer.take(message);
  return viewer.ids();
}

test("built with the body: what a viewer would have seen live", async () => {
  const map = mapOf("body");
  const byTopic = await readIndexed(file("body/session.mcap"));
  const tf = byTopic["/tf"];
  assert.ok(tf.every(({ message }) => message.transforms.length === 24));
  const duration = tf.at(-1).time;
  assert.ok(duration > 60);
  assert.ok(Math.abs(tf.length - 5 * duration) < 10, `${tf.length} in ${duration} s`);
  assert.deepEqual(lastScene(byTopic), idsOf(map));
  assert.ok(byTopic["/map/scene"].length > map.objects.length / 2, "the map grows");
  assert.equal(byTopic["/map/floor"].length, byTopic["/map/trajectory"].length);
  const found = byTopic["/log"].map(({ message }) => message.message);
  for (const { type, id } of map.objects) assert.ok(found.includes(`${type} ${id} found`), `${type} ${id}`);
});

test("built without: the key poses, and each object from when it was seen", async () => {
  const map = mapOf("key-poses");
  const byTopic = await readIndexed(file("key-poses/session.mcap"));
  assert.deepEqual(lastScene(byTopic), idsOf(map));
  assert.equal(byTopic["/tf"].length, map.graph.key_poses);
  assert.equal(byTopic["/map/trajectory"][0].message.poses.length, map.graph.key_poses);
  const visits = map.objects.reduce((sum, { observations }) => sum + observations, 0);
  assert.equal(byTopic["/log"].length, visits);
  for (const { time, message } of byTopic["/map/scene"])
    for (const { id } of message.entities) {
      const object = map.objects.find((o) => `object/${o.id}` === id);
      if (object) assert.ok(Math.abs(time - object.first_seen) < 1e-5, id);
    }
});

test("cut short anywhere, all whole chunks are read", () => {
  const bytes = file("body/session.mcap");
  const whole = countStreamed(bytes);
  assert.ok(whole.done);
  let before = 0;
  for (let part = 0; part <= 20; ++part) {
    const { count, done } = countStreamed(bytes.subarray(0, Math.floor((bytes.length * part) / 21) + part));
    assert.ok(!done);
    assert.ok(count >= before && count <= whole.count);
    if (part > 2) assert.ok(count > ((part - 2) / 21) * whole.count, `${count} of ${whole.count} in ${part}/21`);
    before = count;
  }
  assert.throws(() => {
    const damaged = Buffer.from(bytes);
    damaged[Math.floor(bytes.length / 2)] ^= 1;
    countStreamed(damaged);
  }, "a checksum tells");
});

test("the daemon exports one, too", async () => {
  const daemon = await Daemon.start();
  try {
    await run("kinemap", "replay", join(folder, "session.pcap"), "--to", `127.0.0.1:${daemon.suitPort}`, "--speed", "40");
    const answer = await fetch(`http://127.0.0.1:${daemon.port}/api/v1/export/session.mcap`);
    assert.equal(answer.status, 200);
    const byTopic = await readIndexed(new Uint8Array(await answer.arrayBuffer()));
    assert.ok(byTopic["/tf"].length > 50);
    assert.ok(byTopic["/map/scene"].length > 3);
  } finally {
    await daemon.stop();
  }
});
