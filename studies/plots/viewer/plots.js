// SPDX-License-Identifier: GPL-3.0-or-later
// Curves of columns over time, with a line at the present time.
'use strict';

// About `count` round numbers from low to high
function ticks(low, high, count) {
  const span = high - low;
  if (!(span > 0)) return [low];
  const power = Math.pow(10, Math.floor(Math.log10(span / count)));
  const step = power * [1, 2, 5, 10].find(m => span / (m * power) <= count);
  const all = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * span; ++k) all.push(k * step);
  return all;
}

function number_text(v) {
  if (v === 0 || Number.isNaN(v)) return String(v);
  return Math.abs(v) >= 1e5 || Math.abs(v) < 1e-3 ? v.toExponential(3) : String(Number(v.toPrecision(7)));
}

// Numbers with the digits that tell neighbours apart
function tick_texts(all) {
  const step = all.length > 1 ? all[1] - all[0] : 0, most = Math.max(...all.map(Math.abs));
  if (!(step > 0)) return all.map(number_text);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  if (most < 1e6 && decimals <= 6) return all.map(v => v.toFixed(decimals));
  const digits = v => Math.min(8, Math.max(0, Math.round(Math.log10(Math.abs(v) / step))));
  return all.map(v => Math.abs(v) < 1e-9 * step ? '0' : v.toExponential(digits(v)));
}

class Plot {
  // tables: [{ times, columns: [{ name, unit, values }] }]
  constructor(tables, name, set_time) {
    this.tables = tables;
    this.set_time = set_time;
    this.element = document.createElement('div');
    this.element.className = 'plot';
    this.select = document.createElement('select');
    this.select.setAttribute('aria-label', 'Column');
    for (const table of tables)
      for (const { name: of, unit } of table.columns) this.select.add(new Option(unit ? `${of} [${unit}]` : of, of));
    this.select.value = name;
    this.canvas = document.createElement('canvas');
    const remove = document.createElement('button');
    remove.type = 'button';
    remove.textContent = 'Remove';
    remove.onclick = () => { this.element.remove(); this.removed = true; };
    this.element.append(this.select, ' ', remove, this.canvas);
    this.select.onchange = () => this.draw(this.t);
    this.canvas.onclick = event => {
      const box = this.canvas.getBoundingClientRect(), s = (event.clientX - box.left - this.left) / (box.width - this.left - 8);
      this.set_time(this.low + Math.min(1, Math.max(0, s)) * (this.high - this.low));
    };
    this.left = 66;
  }

  column() {
    for (const table of this.tables) {
      const column = table.columns.find(c => c.name === this.select.value);
      if (column) return { times: times_of(table), values: values_of(column) };
    }
    return null;
  }

  draw(t) {
    this.t = t;
    const of = this.column(), ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!of || !width) return;
    this.canvas.width = ratio * width;
    this.canvas.height = ratio * height;
    const g = this.canvas.getContext('2d');
    g.scale(ratio, ratio);
    const finite = of.values.filter(Number.isFinite);
    let low = Infinity, high = -Infinity;
    for (const v of finite) { low = Math.min(low, v); high = Math.max(high, v); }
    if (!finite.length) { low = 0; high = 1; }
    const margin = high > low ? 0.05 * (high - low) : 0.5 * Math.abs(low) || 1;
    low -= margin; high += margin;
    this.low = of.times[0];
    this.high = of.times[of.times.length - 1];
    const left = this.left, bottom = height - 20, right = width - 8;
    const x = time => left + (right - left) * (this.high > this.low ? (time - this.low) / (this.high - this.low) : 0.5);
    const y = v => 6 + (bottom - 6) * (high - v) / (high - low);
    g.font = '11px sans-serif';
    g.strokeStyle = '#e4e4e4';
    g.fillStyle = '#444';
    g.textAlign = 'right';
    g.textBaseline = 'middle';
    const rows = ticks(low, high, 4), row_texts = tick_texts(rows);
    rows.forEach((v, k) => {
      g.beginPath(); g.moveTo(left, y(v)); g.lineTo(right, y(v)); g.stroke();
      g.fillText(row_texts[k], left - 4, y(v));
    });
    g.textAlign = 'center';
    g.textBaseline = 'top';
    const marks = ticks(this.low, this.high, 5), mark_texts = tick_texts(marks);
    marks.forEach((v, k) => {
      g.beginPath(); g.moveTo(x(v), 6); g.lineTo(x(v), bottom); g.stroke();
      g.fillText(mark_texts[k], Math.min(x(v), right - 8), bottom + 3);
    });
    g.strokeStyle = '#0072b2';
    g.lineWidth = 1.3;
    g.beginPath();
    let pen = false;
    of.values.forEach((v, k) => {
      if (!Number.isFinite(v)) { pen = false; return; }
      if (pen) g.lineTo(x(of.times[k]), y(v)); else g.moveTo(x(of.times[k]), y(v));
      pen = true;
    });
    g.stroke();
    g.strokeStyle = '#d55e00';
    g.beginPath(); g.moveTo(x(t), 6); g.lineTo(x(t), bottom); g.stroke();
    const value = of.values[interval(of.times, t).k];
    g.fillStyle = '#d55e00';
    g.textAlign = x(t) > 0.6 * width ? 'right' : 'left';
    g.fillText(number_text(value), x(t) + (x(t) > 0.6 * width ? -4 : 4), 8);
  }
}
