// Channels over time, beside the picture; the cursor is the present time.

const CURVES = {
  light: ["#1f5fbf", "#b3402a", "#1f7a5c", "#6d4aa3", "#c96a00", "#00798c"],
  dark: ["#7db0ff", "#ff8a73", "#5fd0a5", "#c3a2ff", "#ffb057", "#55cfe0"],
};
const dark = window.matchMedia("(prefers-color-scheme: dark)");
const cards = [];
let added = 0;

function addCard(name) {
  const card = document.createElement("div"), head = document.createElement("div");
  const select = document.createElement("select"), value = document.createElement("output");
  const close = document.createElement("button"), canvas = document.createElement("canvas");
  card.className = "card";
  select.setAttribute("aria-label", "Channel of this plot");
  for (const track of scene.tracks) select.add(new Option(track.unit === "1" ? track.name : `${track.name} (${track.unit})`, track.name));
  select.value = name;
  close.textContent = "×";
  close.title = "Remove this plot";
  close.setAttribute("aria-label", "Remove this plot");
  head.append(select, value, close);
  card.append(head, canvas);
  document.getElementById("cards").append(card);
  const made = { card, canvas, value, select, picture: null, number: added++ };
  cards.push(made);
  select.addEventListener("change", () => { made.picture = null; redraw(); });
  close.addEventListener("click", () => {
    cards.splice(cards.indexOf(made), 1);
    card.remove();
    resized();
  });
  watchTime(canvas, (x) => timeAt(x, made));
  resizes.observe(canvas);
}

const LEFT = 50, RIGHT = 8, TOP = 6, BOTTOM = 6;

function timeAt(x, card) {
  const wide = card.canvas.clientWidth - LEFT - RIGHT;
  return first + ((x - LEFT) / wide) * (last - first);
}

function plotCurve(card) {
  const track = scene.tracks.find((t) => t.name === card.select.value), n = track.values.numbers;
  const ratio = window.devicePixelRatio || 1, wide = card.canvas.clientWidth, high = card.canvas.clientHeight;
  if (!wide || !high) return null;
  card.canvas.width = Math.round(wide * ratio);
  card.canvas.height = Math.round(high * ratio);
  let low = Infinity, up = -Infinity;
  for (const v of n) { if (v < low) low = v; if (v > up) up = v; }
  // rounding is no curve
  const least = ["m", "rad", "m/s", "rad/s"].includes(track.unit) ? 1e-12 * (track.unit[0] === "m" ? scene.size : 1) : 0;
  if (up - low < least && Math.abs(up) < 1e-9) [low, up] = [-1e-9, 1e-9];
  else if (!(up - low > 1e-9 * Math.max(Math.abs(up), Math.abs(low)))) [low, up] = [low - (Math.abs(low) || 1) * 0.5, up + (Math.abs(up) || 1) * 0.5];
  const x = (t) => LEFT + ((t - first) / (last - first || 1)) * (wide - LEFT - RIGHT);
  const y = (v) => TOP + (1 - (v - low) / (up - low)) * (high - TOP - BOTTOM);
  const picture = document.createElement("canvas");
  picture.width = card.canvas.width;
  picture.height = card.canvas.height;
  const g = picture.getContext("2d"), soft = style("--soft"), edge = style("--edge");
  g.scale(ratio, ratio);
  g.font = "10.5px system-ui, sans-serif";
  g.fillStyle = soft;
  g.textAlign = "right";
  g.textBaseline = "middle";
  const step = round((up - low) / Math.max(1, Math.floor(high / 28)));
  // a small change of a large number: the axis shows the change
  const base = step < 1e-4 * Math.max(Math.abs(low), Math.abs(up)) ? step * Math.round(low / step) : null;
  for (let k = Math.ceil(low / step - 1e-9); k * step <= up * (1 + 1e-12) + 1e-9 * step; k++) {
    const at = Math.round(y(k * step)) + 0.5;
    strokeLine(g, [[LEFT, at], [wide - RIGHT, at]], k === 0 ? soft : edge, k === 0 ? 0.9 : 0.6);
    g.fillText(base === null ? short(k * step, step) : short(k * step - base, step), LEFT - 5, at);
  }
  if (base !== null) {
    g.textAlign = "left";
    g.fillText(`${shown(base, track.unit)} +`, LEFT + 3, TOP + 4);
  }
  g.beginPath();
  for (let k = 0; k < n.length; k++) {
    if (k && track.steps) g.lineTo(x(times[k]), y(n[k - 1]));
    if (k) g.lineTo(x(times[k]), y(n[k])); else g.moveTo(x(times[k]), y(n[k]));
  }
  g.strokeStyle = curveColour(card);
  g.lineWidth = 1.5;
  g.lineJoin = "round";
  g.stroke();
  return { picture, track, x, y, high, ratio };
}

// A number on an axis, with as many digits as its neighbours need.
function short(value, step) {
  const zero = Math.abs(value) < 1e-9 * step ? 0 : value, digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const plain = zero.toFixed(Math.min(digits, 20));
  const text = plain.length <= 7 && Math.abs(zero) < 1e6 ? plain : zero === 0 ? "0" : zero.toExponential(Math.min(4, Math.max(0, Math.floor(Math.log10(Math.abs(zero)) + 1e-9) - Math.floor(Math.log10(step) + 1e-9))));
  return text.replace("-", "−");
}

function drawPlots(time) {
  const where = place(time);
  for (const card of cards) {
    card.picture = card.picture || plotCurve(card);
    if (!card.picture) continue;
    const { picture, track, x, y, high, ratio } = card.picture, g = card.canvas.getContext("2d");
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.clearRect(0, 0, card.canvas.width, card.canvas.height);
    g.drawImage(picture, 0, 0);
    g.scale(ratio, ratio);
    const value = at(track.values, track.steps ? { k: where.k, x: 0 } : where, 1, 0);
    strokeLine(g, [[x(time), 2], [x(time), high - 2]], style("--soft"), 1);
    g.beginPath();
    g.arc(x(time), y(value), 3.5, 0, 2 * Math.PI);
    g.fillStyle = curveColour(card);
    g.fill();
    card.value.textContent = shown(value, track.unit);
  }
}

function curveColour(card) {
  const colours = CURVES[dark.matches ? "dark" : "light"];
  return colours[card.number % colours.length];
}

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
