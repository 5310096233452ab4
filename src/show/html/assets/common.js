// SPDX-License-Identifier: Apache-2.0
'use strict';
// What our pages have in common.
const airtruth = (() => {
  const dark = matchMedia('(prefers-color-scheme: dark)').matches;
  Chart.defaults.color = dark ? '#9aa7b4' : '#5c6b7a';
  Chart.defaults.borderColor = dark ? '#30363d' : '#e3e8ed';
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.font.size = 11;
  const element = (tag, text, name) => {
    const made = document.createElement(tag);
    if (text !== undefined) made.textContent = text;
    if (name) made.className = name;
    return made;
  };
  // The colour of truth alone.
  const ink = dark ? '#ffffff' : '#000000';

  // The axis of a described plot. Places with names have all their names, upright where there are many.
  const isPower = (value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;
  const described = ({ label, min, max, names, logarithmic }) => ({
    ...(names.length
      ? { type: 'category', ticks: { autoSkip: false, minRotation: names.length > 5 ? 90 : 0, font: { size: 9 } }, grid: { display: false } }
      : { type: logarithmic ? 'logarithmic' : 'linear', min: min ?? undefined, max: max ?? undefined,
        ticks: logarithmic ? { callback: (value) => (isPower(value) ? String(Number(value.toPrecision(1))) : '') } : { maxTicksLimit: 11 } }),
    title: { display: Boolean(label), text: label },
  });

  // Upright intervals on the bars of a plot.
  const whiskers = (plot) => ({
    id: 'whiskers',
    afterDatasetsDraw: (chart) => {
      const { ctx } = chart;
      ctx.save();
      ctx.strokeStyle = Chart.defaults.color;
      ctx.lineWidth = 1;
      plot.series.forEach((series, k) => {
        if (series.mark !== 'bars' || !series.low.length) return;
        series.x.forEach((place, i) => {
          const bar = chart.getDatasetMeta(k).data[place];
          if (!bar || series.low[i] === null) return;
          const [low, high] = [series.low[i], series.high[i]].map((value) => chart.scales.y.getPixelForValue(value));
          const cap = Math.min(4, bar.width / 3);
          ctx.beginPath();
          for (const y of [low, high]) { ctx.moveTo(bar.x - cap, y); ctx.lineTo(bar.x + cap, y); }
          ctx.moveTo(bar.x, low);
          ctx.lineTo(bar.x, high);
          ctx.stroke();
        });
      });
      ctx.restore();
    },
  });

  // Draws a plot that the program describes (show/plot/plot.h).
  const drawPlot = (canvas, plot) => {
    const { names } = plot.x;
    const placed = (x, values) => names.length
      ? names.map((_, place) => (x.includes(place) ? values[x.indexOf(place)] : null))
      : x.map((at, i) => ({ x: at, y: values[i] }));
    const datasets = plot.series.flatMap((series) => {
      const { colour, dash, width } = series.style;
      const paint = colour === 'ink' ? ink : colour;
      const isBars = series.mark === 'bars';
      const shape = isBars ? {} :
        { type: 'line', borderColor: paint, borderWidth: 1.5 * width, borderDash: dash, showLine: series.mark !== 'points', pointRadius: series.mark === 'line' ? 0 : 2.5 };
      const own = { label: series.name, data: placed(series.x, series.y), backgroundColor: paint, ...shape };
      if (isBars || !series.low.length) return [own];
      const bound = (values, fill) => ({ type: 'line', label: `_${series.name}`, data: placed(series.x, values), pointRadius: 0, borderWidth: 0, backgroundColor: `${paint}26`, fill });
      return [own, bound(series.high, '+1'), bound(series.low, false)];
    });
    const isBars = plot.series.some((series) => series.mark === 'bars');
    return new Chart(canvas, {
      type: isBars ? 'bar' : 'line',
      data: { labels: names.length ? names : undefined, datasets },
      options: { plugins: { legend: { display: false } }, scales: { x: described(plot.x), y: described(plot.y) } },
      plugins: isBars ? [whiskers(plot)] : [],
    });
  };

  // The mark of a style, as the plots draw it.
  const dotOf = ({ colour, dash }) => {
    const dot = element('span', '', 'dot');
    dot.style.background = dash.length
      ? `repeating-linear-gradient(90deg, ${colour} 0 ${dash[0] / 2}px, transparent 0 ${dash[0] / 2 + 2}px)`
      : colour;
    return dot;
  };

  // A table that a click on a heading sorts. A column has a name, what rows are sorted by (`of`), and `up` where it begins ascending;
  // fill(cell, row, column, k) writes a cell of column k.
  const sortable = (table, rows, columns, firstSort, fill) => {
    let by = firstSort;
    let up = false;
    const draw = () => {
      table.replaceChildren();
      const head = table.createTHead().insertRow();
      columns.forEach((column, k) => {
        const cell = element('th');
        const button = element('button', column.name + (k === by ? (up ? ' ▲' : ' ▼') : ''));
        button.type = 'button';
        button.addEventListener('click', () => { up = k === by ? !up : Boolean(column.up); by = k; draw(); });
        cell.append(button);
        head.append(cell);
      });
      const key = columns[by].of;
      const sorted = [...rows].sort((a, b) => {
        const [x, y] = [key(a), key(b)];
        if (x === null || y === null) return (x === null) - (y === null);
        return (x < y ? -1 : x > y ? 1 : 0) * (up ? 1 : -1);
      });
      const body = table.createTBody();
      for (const row of sorted) {
        const line = body.insertRow();
        columns.forEach((column, k) => fill(line.insertCell(), row, column, k));
      }
    };
    draw();
  };

  // What both players of sequences begin with: the list of sequences, a box for each of `shown` that hides it, the buttons and the slider.
  //   sequences, wordsOf(one)   the list and what it says of each; each gets its index
  //   shown, hidden, redraw()   what can be hidden, the set of hidden indices, and what draws anew after a change of it
  //   show(index), current()    shows a sequence; the one that is shown
  //   go(index), play(), stop() the slider and the button
  const beginPlayer = ({ sequences, wordsOf, shown, hidden, redraw, show, current, go, play, stop }) => {
    const byId = (id) => document.getElementById(id);
    sequences.forEach((one, index) => {
      one.index = index;
      const option = element('option', wordsOf(one));
      option.value = index;
      byId('sequence').append(option);
    });
    shown.forEach(({ name, style }, k) => {
      const label = element('label');
      const box = element('input');
      box.type = 'checkbox';
      box.checked = true;
      box.addEventListener('change', () => {
        if (box.checked) hidden.delete(k); else hidden.add(k);
        redraw();
      });
      label.append(box, dotOf(style), document.createTextNode(name));
      byId('shown').append(label);
    });
    byId('sequence').addEventListener('change', () => show(Number(byId('sequence').value)));
    const step = (by) => () => show((current().index + by + sequences.length) % sequences.length);
    byId('previous').addEventListener('click', step(-1));
    byId('next').addEventListener('click', step(1));
    byId('frame').addEventListener('input', () => { stop(); go(Number(byId('frame').value)); });
    byId('play').addEventListener('click', () => (byId('play').textContent === 'Play' ? play() : stop()));
  };

  return {
    beginPlayer,
    byId: (id) => document.getElementById(id),
    ink,
    dotOf,
    drawPlot,
    element,
    sortable,
    least: (values) => (values.length ? values.reduce((a, b) => Math.min(a, b)) : null),
    most: (values) => (values.length ? values.reduce((a, b) => Math.max(a, b)) : null),
    counted: (count, one, more = `${one}s`) => `${count.toLocaleString('en')} ${count === 1 ? one : more}`,
    number: (value, digits = 0) =>
      value === null || value === undefined ? '–' : value.toLocaleString('en', { maximumFractionDigits: digits }),
    line: (label, points, colour, more = {}) =>
      ({ label, data: points, borderColor: colour, backgroundColor: colour, borderWidth: 1.5, pointRadius: 0, showLine: true, ...more }),
    axis: (text, more = {}) => ({ type: 'linear', title: { display: true, text }, ...more }),
    legend: { position: 'top', labels: { boxWidth: 12, filter: (item) => !item.text.startsWith('_') } },
  };
})();
