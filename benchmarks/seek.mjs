// Measures how a viewer opens an MCAP over HTTP and jumps in it, with @mcap/core over ranges.
//
//     npm install @mcap/core @mcap/support
//     node benchmarks/seek.mjs URL
//
// A jump reads what a viewer shows: the last message of each topic before the time, and the next
// half second. Prints requests, megabytes and seconds.
import { McapIndexedReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";

const url = process.argv[2];
const spent = { requests: 0, bytes: 0 };

async function request(range) {
  const answer = await fetch(url, range ? { headers: { Range: range } } : { method: "HEAD" });
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  return answer;
}

const file = {
  async size() {
    return BigInt((await request()).headers.get("content-length"));
  },
  async read(offset, size) {
    spent.requests += 1;
    spent.bytes += Number(size);
    const answer = await request(`bytes=${offset}-${offset + size - 1n}`);
    return new Uint8Array(await answer.arrayBuffer());
  },
};

async function timed(what, work) {
  Object.assign(spent, { requests: 0, bytes: 0 });
  const start = performance.now();
  const result = await work();
  const seconds = (performance.now() - start) / 1000;
  const size = (spent.bytes / 1e6).toFixed(2);
  console.log(`${what}: ${spent.requests} requests, ${size} MB, ${seconds.toFixed(2)} s`);
  return result;
}

async function count(messages) {
  let number = 0;
  for await (const _ of messages) number += 1;
  return number;
}

async function last(reader, topics, time) {
  const seen = new Set();
  for (const topic of topics) {
    const messages = reader.readMessages({ topics: [topic], endTime: time, reverse: true });
    for await (const message of messages) {
      seen.add(message.channelId);
      break;
    }
  }
  return seen.size;
}

const decompressHandlers = await loadDecompressHandlers();
const reader = await timed("open", () =>
  McapIndexedReader.Initialize({ readable: file, decompressHandlers }),
);
const { messageStartTime: start, messageEndTime: end } = reader.statistics;
const topics = [...reader.channelsById.values()].map((channel) => channel.topic);
const added = topics.filter((topic) => /^\/(tf|support|legs|load|label|marker_basic)/.test(topic));
console.log(`${Number(end - start) / 1e9} s, ${topics.length} topics, ${added.length} of ours`);
for (const share of [10n, 50n, 90n]) {
  const time = start + ((end - start) * share) / 100n;
  for (const [name, wanted] of [["ours", added], ["all", topics]]) {
    await timed(`${share} %, last of ${name}`, () => last(reader, wanted, time));
    const window = { topics: wanted, startTime: time, endTime: time + 500_000_000n };
    await timed(`${share} %, 0.5 s of ${name}`, () => count(reader.readMessages(window)));
  }
}
