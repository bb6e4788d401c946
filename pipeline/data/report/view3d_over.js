// What stands over the formed part: axes, scale bar, the scale of the colours, the cursor, and its place in words.
"use strict";
(function () {
  const { seen } = window.planishPaint;
  const STRETCHED = [213, 94, 0], PRESSED = [0, 114, 178], WHITE = [255, 255, 255], UNKNOWN = [150, 150, 150];
  const INK = {
    light: { c0: "#0072B2", c1: "#D55E00", start: "#007D5C", end: "#555555", ruling: "#8C8C8C", mark: "#1A1A1A", hole: "#1A1A1A", bend: "#B0307A", worst: "#B0307A", ink: "#1A1A1A", paper: "#FFFFFF" },
    dark: { c0: "#3AA0DC", c1: "#F28A3C", start: "#35B58F", end: "#B8B8B8", ruling: "#6F767D", mark: "#1A1A1A", hole: "#C8C8C8", bend: "#B0307A", worst: "#B0307A", ink: "#E8E8E8", paper: "#15181C" },
  };
  const LEFT = 84, TYPE = "12px system-ui, sans-serif", CURSOR = "#B0307A";

  // The colour of a share of the limit: white at 0, orange at +1, blue at -1 and beyond; grey where there is no value.
  function colour(share) {
    if (!(Math.abs(share) >= 0)) return UNKNOWN;
    const end = share >= 0 ? STRETCHED : PRESSED, size = Math.min(Math.abs(share), 1);
    return WHITE.map((white, k) => white + size * (end[k] - white));
  }

  const digits = (x) => x === 0 ? "0" : Number(x.toPrecision(3)).toString().replace("-", "\u2212");
  const told = (field, value) => field.unit === "1" ? `${digits(100 * value)} %` : `${digits(value)} ${field.unit}`;
  const radius = (field, value) => field.name === "curvature" && Math.abs(value) > 1e-12 ? `, radius ${digits(1 / Math.abs(value))} mm` : "";

  function words(spot, field) {
    const place = spot.u === undefined ? [] : [`u ${spot.u.toFixed(3)}`, `v ${spot.v.toFixed(3)}`];
    if (spot.x !== undefined) place.push(`x ${spot.x.toFixed(1)}`, `y ${spot.y.toFixed(1)} mm flat`);
    const told_ = field && spot.value !== undefined ? `${field.title} ${told(field, spot.value)}${radius(field, spot.value)}` : "";
    return [place.join("   "), told_].filter(Boolean).join("\n");
  }

  function line(pen, points) {
    pen.beginPath();
    for (const [x, y] of points) pen.lineTo(x, y);
    pen.stroke();
  }

  // scene: { theme, field: null | a field, beyond: whether one of its values is, deviation: in words, spot, at: place -> point }
  function draw(pen, sight, scene) {
    pen.font = TYPE;
    pen.fillStyle = pen.strokeStyle = INK[scene.theme].ink;
    axes(pen, sight);
    scaleBar(pen, sight);
    if (scene.field) legend(pen, sight, scene);
    else { pen.textAlign = "left"; pen.fillText(scene.deviation, LEFT, sight.height - 14, sight.width - LEFT - 170); }
    if (scene.spot) cursor(pen, sight, scene);
  }

  function cursor(pen, sight, { spot, ends, theme }) {
    if (ends) {
      pen.lineWidth = 1.5;
      pen.setLineDash([5, 3]);
      line(pen, ends.map((end) => seen(sight, ...end)));
      pen.setLineDash([]);
    }
    const [x, y] = seen(sight, ...spot);
    for (const [r, tone] of [[6, "#FFFFFF"], [4.5, CURSOR]]) {
      pen.beginPath();
      pen.arc(x, y, r, 0, 7);
      pen.fillStyle = tone;
      pen.fill();
    }
    pen.fillStyle = INK[theme].ink;
  }

  function axes(pen, sight) {
    const [x, y] = [40, sight.height - 40];
    pen.lineWidth = 1.3;
    pen.textAlign = "center";
    "xyz".split("").forEach((name, k) => {
      const [dx, dy] = [20 * sight.frame[0][k], -20 * sight.frame[1][k]], far = Math.hypot(dx, dy) || 1;
      line(pen, [[x, y], [x + dx, y + dy]]);
      pen.fillText(name, x + dx + 8 * dx / far, y + dy + 8 * dy / far + 4);
    });
  }

  function scaleBar(pen, sight) {
    const most = Math.min(140, sight.width / 4) / sight.scale, power = 10 ** Math.floor(Math.log10(most));
    const long = [5, 2, 1].find((one) => one * power <= most) * power, [x, y] = [sight.width - 16, sight.height - 14];
    const left = x - long * sight.scale;
    pen.lineWidth = 1.5;
    line(pen, [[left, y - 5], [left, y], [x, y], [x, y - 5]]);
    pen.textAlign = "right";
    pen.fillText(`${digits(long)} mm`, x, y - 9);
  }

  // The scale of the colours, its ends pointed where a value lies beyond them.
  function legend(pen, sight, { field, theme, beyond }) {
    const [x, y, wide] = [LEFT, sight.height - 32, Math.max(90, Math.min(240, sight.width - 275))];
    for (let i = 0; i < wide; i++) {
      pen.fillStyle = `rgb(${colour(2 * (i + 0.5) / wide - 1).map(Math.round).join()})`;
      pen.fillRect(x + i, y, 1.5, 10);
    }
    pen.strokeStyle = INK[theme].ink;
    pen.lineWidth = 0.8;
    pen.strokeRect(x, y, wide, 10);
    const scale = field.unit === "1" ? 100 : 1, sign = field.unit === "1" ? " %" : "";
    pen.fillStyle = INK[theme].ink;
    [-1, 0, 1].forEach((share, k) => {
      pen.textAlign = ["left", "center", "right"][k];
      pen.fillText(`${share > 0 ? "+" : ""}${digits(share * scale * field.limit)}${share ? sign : ""}`, x + wide * (share + 1) / 2, y + 23);
    });
    pen.textAlign = "left";
    const title = `${field.title}${field.unit === "1" ? "" : `, ${field.unit}`} (${field.evidence})${beyond ? ": \u25b2 beyond the scale" : ""}`;
    pen.fillText(title, x, y - 6, sight.width - x - 8);
  }

  window.planishOver = { draw, words, colour, INK };
})();
