// SPDX-License-Identifier: Apache-2.0
// A real kinemapd under Foxglove's own WebSocket client.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { WebSocket } from "ws";

import { settled } from "../settled.mjs";
import { checkOwnSchema, checkSchema, connect, Daemon, idsOf, jsonOf, next, Viewer } from "./support.mjs";

const topics = {
  "/tf": "foxglove.FrameTransforms",
  "/map/scene": "foxglove.SceneUpdate",
  "/map/trajectory": "foxglove.PosesInFrame",
  "/map/floor": "foxglove.Grid",
  "/log": "foxglove.Log",
};

let daemon;
before(async () => (daemon = await Daemon.start()));
after(() => daemon.stop());

/** The JSON answer of a service. */
async function call({ client, services }, name, request) {
  const serviceId = services.find((s) => s.name === name).id;
  const callId = Math.floor(Math.random() * 2 ** 32);
  const answer = Promise.race([
    next(client, "serviceCallResponse", (r) => r.callId === callId),
    next(client, "serviceCallFailure", (r) => r.callId === callId),
  ]);
  const data = new TextEncoder().encode(request === undefined ? "" : JSON.stringify(request));
  client.sendServiceCallRequest({ serviceId, callId, encoding: "json", data });
  const { op, data: bytes, message, encoding } = await answer;
  if (op === "serviceCallFailure") return { failure: message };
  assert.equal(encoding, "json");
  return jsonOf(bytes);
}

test("another subprotocol, or none, is refused with what there is", async () => {
  for (const offered of [[], ["foxglove.websocket.v9"]]) {
    const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/`, offered);
    socket.on("error", () => {});
    const [, answer] = await new Promise((resolve) => socket.on("unexpected-response", (...args) => resolve(args)));
    assert.equal(answer.statusCode, 400);
    let body = "";
    for await (const data of answer) body += data;
    assert.match(JSON.parse(body).error.message, /foxglove\.sdk\.v1 or foxglove\.websocket\.v1/);
  }
});

for (const subprotocol of ["foxglove.sdk.v1", "foxglove.websocket.v1"])
  test(`${subprotocol}: the server says what it has`, async () => {
    const session = await connect(daemon, subprotocol);
    assert.equal(session.socket.protocol, subprotocol);
    assert.deepEqual(session.serverInfo.capabilities, ["time", "services"]);
    assert.deepEqual(Object.fromEntries(session.channels.map((c) => [c.topic, c.schemaName])), topics);
    for (const channel of session.channels) {
      assert.equal(channel.encoding, "json");
      assert.equal(channel.schemaEncoding, "jsonschema");
      assert.equal(JSON.parse(channel.schema).type, "object");
    }
    session.client.close();
  });

test("a wearer walks: every channel fits Foxglove's schemas, and the scene is the map", { timeout: 120e3 }, async () => {
  const session = await connect(daemon);
  const { client } = session;
  const bySubscription = new Map();
  for (const topic of Object.keys(topics))
    bySubscription.set(client.subscribe(session.channel(topic).id), session.channel(topic));
  const counts = Object.fromEntries(Object.keys(topics).map((topic) => [topic, 0]));
  const viewer = new Viewer();
  const frames = new Set();
  let failure, time = 0n, floor, trajectory;
  client.on("time", ({ timestamp }) => {
    if (timestamp < time) failure ??= new Error("time runs backwards");
    time = timestamp;
  });
  client.on("message", ({ subscriptionId, data }) => {
    const { topic, schemaName, schema } = bySubscription.get(subscriptionId);
    const message = jsonOf(data);
    ++counts[topic];
    try {
      checkSchema(schemaName, message);
      checkOwnSchema(schema, message);
      if (topic === "/map/scene") viewer.take(message);
      if (topic === "/map/floor") floor = message;
      if (topic === "/map/trajectory") trajectory = message;
      if (topic === "/tf") message.transforms.forEach((t) => frames.add(`${t.parent_frame_id}>${t.child_frame_id}`));
    } catch (error) {
      failure ??= error;
    }
  });

  // Of this seed some object is first taken for a new one and joined with a known one later.
  await daemon.walk("--seed", "11", "--rooms", "1", "--rounds", "2", "--speed", "20");
  // The last revision comes once the suit has been silent for a while; then scene and map are one.
  await settled(`http://127.0.0.1:${daemon.port}/`);
  const map = await daemon.get("/api/v1/map");
  for (let i = 0; viewer.ids().join() !== idsOf(map).join(); ++i) {
    assert.ok(i < 150, `scene: ${viewer.ids()}; map: ${idsOf(map)}`);
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
  if (failure) throw failure;
  assert.ok(map.objects.length > 5, "the wearer traced some objects");
  for (const [topic, count] of Object.entries(counts)) assert.ok(count > 0, `nothing came on ${topic}`);
  assert.ok(viewer.deleted > 0, "something was joined with another and had to go");
  for (const chain of ["map>odom", "odom>pelvis", "t8>neck", "right_forearm>right_hand", "left_foot>left_toe"])
    assert.ok(frames.has(chain), chain);
  assert.equal(frames.size, 24);
  assert.ok(time > 200n * 10n ** 9n, "minutes of stream time");

  const cells = Buffer.from(floor.data, "base64");
  assert.equal(cells.length % floor.row_stride, 0);
  assert.ok(cells.filter((_, i) => i % 4 === 3).some((alpha) => alpha > 0), "some floor was walked");
  assert.ok(trajectory.poses.length > 100);

  // Whoever comes later gets all of it at once.
  const late = await connect(daemon);
  late.client.subscribe(late.channel("/map/scene").id);
  const whole = jsonOf((await next(late.client, "message")).data);
  assert.deepEqual(whole.entities.map((e) => e.id).sort(), idsOf(map));
  assert.deepEqual(whole.entities.map((e) => JSON.stringify(e)).sort(), [...viewer.entities.values()].map((e) => JSON.stringify(e)).sort());
  late.client.close();
  client.close();
});

test("the queries are services", async () => {
  const session = await connect(daemon);
  for (const { request } of session.services) assert.equal(JSON.parse(request.schema).type, "object");
  const map = await call(session, "/kinemap/map");
  assert.deepEqual(map.objects, (await daemon.get("/api/v1/map")).objects);
  const [x, y] = map.objects[0].pose.position;
  const near = await call(session, "/kinemap/objects", { near: [x, y], within: 1, limit: 1, type: map.objects[0].type });
  assert.equal(near.objects.length, 1);
  assert.deepEqual(near, await daemon.get(`/api/v1/objects?near=${x},${y}&within=1&limit=1&type=${map.objects[0].type}`));
  assert.deepEqual(await call(session, "/kinemap/objects/by_id", { id: map.objects[0].id }), map.objects[0]);
  assert.ok((await call(session, "/kinemap/status")).suit.stream.frames > 1000);
  assert.match((await call(session, "/kinemap/objects/by_id", { id: 4711 })).failure, /no object 4711/);
  assert.match((await call(session, "/kinemap/objects/by_id", {})).failure, /needs "id"/);
  assert.match((await call(session, "/kinemap/objects", { limit: 0 })).failure, /limit/);
  assert.match((await call(session, "/kinemap/objects", [1])).failure, /JSON object/);
  session.client.close();
});

test("bad input gets a status message and the connection stays", async () => {
  const session = await connect(daemon);
  const complaint = async (message) => {
    const status = next(session.client, "status");
    session.socket.send(message);
    const { level, message: text } = await status;
    assert.equal(level, 2);
    return text;
  };
  assert.match(await complaint("{"), /JSON object/);
  assert.match(await complaint("[]"), /JSON object/);
  assert.match(await complaint('{"op":"dance"}'), /dance is not served/);
  assert.match(await complaint('{"op":"getParameters","parameterNames":[]}'), /not served/);
  assert.match(await complaint('{"op":"subscribe"}'), /needs "subscriptions"/);
  assert.match(await complaint('{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]}'), /needs "subscriptions"/);
  assert.match(await complaint('{"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]}'), /no channel 99/);
  assert.match(await complaint('{"op":"unsubscribe","subscriptionIds":[7]}'), /no subscription 7/);
  assert.match(await complaint(Buffer.from([])), /service requests/);
  assert.match(await complaint(Buffer.from([1, 0, 0, 0, 0])), /service requests/);
  for (let length = 1; length < 13; ++length) assert.match(await complaint(Buffer.alloc(length, 2)), /13 bytes/);
  assert.match(await complaint(Buffer.alloc(20, 2)), /longer than the message/);

  session.client.subscribe(session.channel("/tf").id); // the client's first id is 0
  assert.match(await complaint('{"op":"subscribe","subscriptions":[{"id":0,"channelId":2}]}'), /0 is in use/);
  assert.match(await complaint('{"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]}'), /tf is subscribed already/);
  await next(session.client, "message");
  const unknown = next(session.client, "serviceCallFailure");
  session.client.sendServiceCallRequest({ serviceId: 999, callId: 1, encoding: "json", data: new Uint8Array() });
  assert.match((await unknown).message, /no service 999/);
  session.client.close();
});

test("who asks without reading is disconnected, and counted", async () => {
  const before = (await daemon.get("/api/v1/status")).clients.slow_clients_closed;
  const session = await connect(daemon);
  const id = session.services.find((s) => s.name === "/kinemap/trajectory").id;
  session.socket.pause();
  const closed = new Promise((resolve) => session.socket.on("close", resolve));
  for (let callId = 0; callId < 2000; ++callId)
    session.client.sendServiceCallRequest({ serviceId: id, callId, encoding: "json", data: new Uint8Array() });
  for (let i = 0; ; ++i) {
    const { slow_clients_closed } = (await daemon.get("/api/v1/status")).clients;
    if (slow_clients_closed > before) break;
    assert.ok(i < 300, "not within a minute");
    await new Promise((resolve) => setTimeout(resolve, 200));
  }
  session.socket.resume();
  await closed;
});
