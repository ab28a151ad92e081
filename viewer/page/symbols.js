// Springs, dampers, arrows: shapes that are made between points on the screen. `u` is a hundredth of the scene, pixels.

const SPRING = "#6d4aa3", INK = "#1f3a5f";

function strokeLine(g, points, colour, width, closed) {
  g.beginPath();
  points.forEach((p, k) => (k ? g.lineTo(p[0], p[1]) : g.moveTo(p[0], p[1])));
  if (closed) g.closePath();
  g.strokeStyle = colour;
  g.lineWidth = width;
  g.stroke();
}

function drawLink(g, kind, a, b, u) {
  const dx = b[0] - a[0], dy = b[1] - a[1], length = Math.hypot(dx, dy) || 1e-9;
  const along = (x, y) => [a[0] + (dx * x) / length - (dy * y) / length, a[1] + (dy * x) / length + (dx * y) / length];
  if (kind === "rod") return strokeLine(g, [a, b], INK, Math.max(1.4, 0.5 * u));
  const width = Math.max(1.2, 0.4 * u), w = Math.min(Math.max(4, 2 * u), 0.2 * length);
  const both = kind === "spring-damper", lanes = both ? [[1.3 * w, true], [-1.3 * w, false]] : [[0, kind === "spring"]];
  for (const [y, zigzag] of lanes) {
    const from = 0.2 * length, to = 0.8 * length;
    if (both) strokeLine(g, [along(0.1 * length, y), along(0.1 * length, 0)], SPRING, width);
    if (both) strokeLine(g, [along(0.9 * length, y), along(0.9 * length, 0)], SPRING, width);
    const start = both ? 0.1 * length : 0, end = both ? 0.9 * length : length;
    if (zigzag) {
      const turns = 12, points = [along(start, y), along(from, y)];
      for (let k = 0; k < turns; k++) points.push(along(from + ((to - from) * (k + 0.5)) / turns, y + (k % 2 ? w : -w)));
      points.push(along(to, y), along(end, y));
      strokeLine(g, points, SPRING, width);
    } else {
      const m = 0.5 * length, half = 0.16 * length;
      strokeLine(g, [along(start, y), along(m - 0.5 * half, y)], SPRING, width);
      strokeLine(g, [along(m + half, y + w), along(m - half, y + w), along(m - half, y - w), along(m + half, y - w)], SPRING, width);
      strokeLine(g, [along(m - 0.5 * half, y + 0.75 * w), along(m - 0.5 * half, y - 0.75 * w)], SPRING, 1.6 * width);
      strokeLine(g, [along(m - 0.5 * half, y), along(end, y)], SPRING, width);
    }
    if (both) strokeLine(g, [along(0, 0), along(0.1 * length, 0)], SPRING, width);
    if (both) strokeLine(g, [along(0.9 * length, 0), along(length, 0)], SPRING, width);
  }
}

function drawArrow(g, from, to, colour) {
  const dx = to[0] - from[0], dy = to[1] - from[1], length = Math.hypot(dx, dy);
  if (length < 2) return;
  const head = Math.min(11, 0.6 * length), x = dx / length, y = dy / length;
  const neck = [to[0] - head * x, to[1] - head * y];
  strokeLine(g, [from, neck], colour, 2.2);
  g.beginPath();
  g.moveTo(to[0], to[1]);
  g.lineTo(neck[0] - 0.42 * head * y, neck[1] + 0.42 * head * x);
  g.lineTo(neck[0] + 0.42 * head * y, neck[1] - 0.42 * head * x);
  g.closePath();
  g.fillStyle = colour;
  g.fill();
}

// A text with a light edge, so that it can be read on lines.
function drawText(g, text, x, y, colour, align) {
  g.font = "12px system-ui, sans-serif";
  g.textAlign = align || "left";
  g.textBaseline = "middle";
  g.lineWidth = 3.5;
  g.lineJoin = "round";
  g.strokeStyle = "#fbfcfee6";
  g.strokeText(text, x, y);
  g.fillStyle = colour;
  g.fillText(text, x, y);
}
