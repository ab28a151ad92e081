// The line of time with the events on it.

const MARKS = { impact: "#b3402a", close: "#c96a00", open: "#1f7a5c", rest: "#6b7280", graze: "#8a6d00", stick: "#6d4aa3", slip: "#00798c" };
const stops = [...new Set(scene.events.map((event) => event.t))].sort((a, b) => a - b);
const blows = new Map();
for (const event of scene.events) {
  if (event.kind !== "impact") continue;
  if (!blows.has(event.contact)) blows.set(event.contact, []);
  blows.get(event.contact).push(event);
}
const hardest = Math.max(0, ...scene.events.map((event) => event.impulse || 0));
const EDGE = 7;

function lineX(t, wide) {
  return EDGE + ((t - first) / (last - first || 1)) * (wide - 2 * EDGE);
}

function drawTimeline(canvas, time) {
  const ratio = window.devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
  if (canvas.width !== Math.round(wide * ratio)) canvas.width = Math.round(wide * ratio);
  if (canvas.height !== Math.round(high * ratio)) canvas.height = Math.round(high * ratio);
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, wide, high);
  g.lineCap = "round";
  const y = 15;
  strokeLine(g, [[EDGE, y], [wide - EDGE, y]], style("--edge"), 5);
  strokeLine(g, [[EDGE, y], [lineX(time, wide), y]], style("--accent"), 5);
  for (const event of scene.events) {
    const x = lineX(event.t, wide), mark = MARKS[event.kind] || style("--soft");
    strokeLine(g, [[x, y - 8], [x, y + 8]], mark, 1.8);
  }
  g.fillStyle = style("--soft");
  g.font = "11px system-ui, sans-serif";
  g.textBaseline = "middle";
  const step = round((last - first) / Math.max(2, Math.floor(wide / 110)) || 1);
  for (let k = Math.ceil(first / step - 1e-9); k * step <= last + 1e-9 * step; k++) {
    const x = lineX(k * step, wide), text = shown(k * step, "s"), half = 0.5 * g.measureText(text).width;
    g.textAlign = "center";
    g.fillText(text, Math.min(Math.max(x, half), wide - half), 33);
  }
  g.beginPath();
  g.arc(lineX(time, wide), y, 7, 0, 2 * Math.PI);
  g.fillStyle = style("--accent");
  g.fill();
  g.lineWidth = 2;
  g.strokeStyle = style("--card");
  g.stroke();
  canvas.setAttribute("aria-valuemin", first);
  canvas.setAttribute("aria-valuemax", last);
  canvas.setAttribute("aria-valuenow", time);
}

// Which kinds of events there are, and the one at the present time.
function listKinds() {
  const box = document.getElementById("kinds"), counts = new Map();
  for (const event of scene.events) counts.set(event.kind, (counts.get(event.kind) || 0) + 1);
  for (const [kind, count] of counts) {
    const entry = document.createElement("span");
    entry.style.setProperty("--mark", MARKS[kind] || "gray");
    entry.textContent = `${kind} ${count}`;
    box.append(entry);
  }
  const newest = document.createElement("b");
  newest.id = "newest";
  box.append(newest);
  document.getElementById("before").disabled = document.getElementById("after").disabled = !stops.length;
}

function tellEvent(time) {
  const near = 1e-9 * Math.max(Math.abs(last), 1e-9), past = scene.events.filter((event) => event.t <= time + near);
  const event = past[past.length - 1], box = document.getElementById("newest");
  if (!event) return void (box.textContent = "");
  const more = event.impulse ? `, ${shown(event.impulse, event.impulse_unit)}` : "";
  box.textContent = `${shown(event.t, "s")}: ${event.kind} of ${event.contact}${more}`;
}

// The event before or after a time; the end of the run where there is none.
function neighbour(time, forward) {
  const near = 1e-9 * Math.max(last - first, 1e-12);
  if (forward) return stops.find((t) => t > time + near) ?? last;
  return [...stops].reverse().find((t) => t < time - near) ?? first;
}
