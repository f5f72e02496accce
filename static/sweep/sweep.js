// The page of a sweep: what is chosen, and what is drawn again when that changes.
import { compare, maps } from "./compare.js";
import { byId, element } from "./page.js";
import { parallel, scatter } from "./plots.js";
import { breakdown, runs } from "./table.js";

const PERIOD = 5000; // milliseconds between looks at a table that may grow
const AFTER = ["share", "status"];
const TIMES = ["wall_s", "memory_mb"];

const state = { sort: { name: "", down: false }, chosen: [], recording: "", target: "", x: "", y: "" };
let [text, data] = ["", null];

function told(words, note = false) {
  byId("message").textContent = words;
  byId("message").hidden = !words;
  byId("message").className = note ? "note" : "";
}

// Why there is no newer table; nothing once there is one again. Other messages stay.
let why = "";
function missing(words) {
  if (words !== why) told((why = words));
}

// The tab is opened at once: a browser refuses one that comes later.
async function open(key) {
  const tab = window.open("about:blank");
  told("Opening the run …", true);
  try {
    const reply = await fetch("/open", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ key }) });
    const answer = reply.ok ? await reply.json() : { error: await reply.text() };
    if (answer.error) throw new Error(answer.error);
    told(`The run is at ${answer.url}`, true);
    if (tab) tab.location = answer.url;
  } catch (error) {
    tab?.close();
    told(`The run cannot be opened: ${error.message}`);
  }
}

function choose(key) {
  const others = state.chosen.filter((each) => each !== key);
  state.chosen = others.length < state.chosen.length ? others : [...others, key].slice(-2);
  draw();
}

function sort(name) {
  state.sort = { name, down: state.sort.name === name && !state.sort.down };
  draw();
}

function options(id, names, value) {
  byId(id).replaceChildren(...names.map((name) => element("option", { value: name }, name || "all")));
  byId(id).value = value;
}

function draw() {
  const all = data.rows;
  const rows = all.filter((row) => !state.recording || row.recording === state.recording);
  const varied = data.names.filter((name) => new Set(rows.map((row) => row[name])).size > 1);
  const columns = ["recording", ...data.names, ...AFTER, ...data.figures, ...TIMES, "reason"];
  options("target", data.figures, state.target);
  options("recording", ["", ...new Set(all.map((row) => row.recording))], state.recording);
  for (const axis of ["x", "y"]) options(`scatter-${axis}`, [...data.names, ...data.figures, ...TIMES], state[axis]);
  maps(rows, data, state.target, open);
  scatter(rows, [state.x, state.y], state.chosen, choose);
  parallel(rows, [...new Set([...varied, state.target, "consistency"])], state.chosen, choose);
  breakdown(all, data, state.target, (recording) => { state.recording = state.recording === recording ? "" : recording; draw(); });
  runs(rows, columns, state, { onsort: sort, onopen: open, onchoose: choose });
  compare(state.chosen.map((key) => all.find((row) => row.key === key)).filter(Boolean), columns);
}

function head() {
  const counts = new Map();
  for (const row of data.rows) counts.set(row.status, (counts.get(row.status) ?? 0) + 1);
  byId("title").textContent = `Sweep ${data.name}`;
  byId("counts").textContent = `${data.rows.length} runs: ${[...counts].map(([status, count]) => `${count} ${status}`).join(", ")}`;
}

async function look() {
  const reply = await fetch("/data.json");
  const now = await reply.text();
  missing(reply.ok ? "" : now);
  if (!reply.ok || now === text) return;
  [text, data] = [now, JSON.parse(now)];
  state.target ||= data.target;
  state.x ||= data.names[0] ?? "occupied_cells";
  state.y ||= state.target;
  if (!state.sort.name) state.sort = { name: state.target, down: data.higher.includes(state.target) };
  head();
  draw();
}

const light = window.matchMedia("(prefers-color-scheme: light)");
const dress = () => document.documentElement.setAttribute("data-mantine-color-scheme", light.matches ? "light" : "dark");
light.addEventListener("change", dress);
dress();
for (const [id, name] of [["target", "target"], ["recording", "recording"], ["scatter-x", "x"], ["scatter-y", "y"]]) {
  byId(id).addEventListener("change", (event) => { state[name] = event.target.value; draw(); });
}
const silent = () => missing("The server does not answer: start it again.");
await look().catch(silent);
window.setInterval(() => look().catch(silent), PERIOD);
