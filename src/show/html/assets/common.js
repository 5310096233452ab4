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
  const byId = (id) => document.getElementById(id);
  const number = (value, digits = 0) =>
    (value === null || value === undefined ? '–' : value.toLocaleString('en', { maximumFractionDigits: digits }));
  // Of a time to the closest approach, which is negative after it.
  const aroundClosest = (ahead_s) => `${number(Math.abs(ahead_s), 1)} s ${ahead_s < 0 ? 'after' : 'before'} the closest approach`;
  const button = (text, act) => {
    const made = element('button', text);
    made.type = 'button';
    made.addEventListener('click', act);
    return made;
  };
  // The colour of truth alone.
  const ink = dark ? '#ffffff' : '#000000';

  // A name with its middle left out where it is long.
  const shortened = (name, most) => (name.length <= most ? name : `${name.slice(0, Math.ceil(most / 2) - 1)}…${name.slice(1 - Math.floor(most / 2))}`);

  // The axis of a described plot. `bounds`: the ends of its intervals, which it holds too; `areWhole`: its values
  // are counts. Places with names have all their
  // names, upright where they do not fit beside each other; numbers lie flat.
  const isPower = (value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;
  const briefly = (value) => (value >= 1e4 || value < 1e-3 ? `1e${Math.round(Math.log10(value))}` : String(Number(value.toPrecision(1))));
  const longestName = 16;
  const described = ({ label, min, max, names, logarithmic }, bounds, areWhole = false) => ({
    ...(names.length
      ? { type: 'category', grid: { display: false },
        ticks: { autoSkip: false, maxRotation: 90, font: { size: 9 }, callback: (k) => shortened(names[k], longestName) },
        afterCalculateLabelRotation: (scale) => {
          scale.ctx.font = `9px ${Chart.defaults.font.family}`;
          const widest = Math.max(...names.map((name) => scale.ctx.measureText(shortened(name, longestName)).width));
          scale.labelRotation = widest + 4 > (scale.chart.width - 60) / names.length ? 90 : 0;
        } }
      : { type: logarithmic ? 'logarithmic' : 'linear', min: min ?? undefined, max: max ?? undefined,
        ...(bounds.length ? { suggestedMin: Math.min(...bounds), suggestedMax: Math.max(...bounds) } : {}),
        ticks: logarithmic
          ? { maxRotation: 0, callback: (value) => (isPower(value) ? briefly(value) : '') }
          : { maxRotation: 0, maxTicksLimit: 11, ...(areWhole ? { precision: 0 } : {}) } }),
    title: { display: Boolean(label), text: label },
  });
  const boundsOf = (plot) => plot.series.flatMap(({ low, high }) => [...low, ...high]).filter((value) => value !== null);

  // What stands at a named place beside others.
  const isBeside = ({ mark }) => mark === 'bars' || mark === 'dots';
  const paintOf = ({ style }) => (style.colour === 'ink' ? ink : style.colour);

  // Dots and rings in the places of bars, upright intervals on both, and a shade behind every second place of dots.
  const uprights = (plot) => {
    const draw = (chart, series, k) => {
      const { ctx } = chart;
      const isDots = series.mark === 'dots';
      series.x.forEach((place, i) => {
        const bar = chart.getDatasetMeta(k).data[place];
        if (!bar || series.y[i] === null) return;
        const at = (value) => chart.scales.y.getPixelForValue(value);
        ctx.strokeStyle = isDots ? paintOf(series) : Chart.defaults.color;
        ctx.lineWidth = 1;
        if (series.low.length && series.low[i] !== null) {
          const cap = Math.min(4, bar.width / 3);
          ctx.beginPath();
          for (const y of [at(series.low[i]), at(series.high[i])]) { ctx.moveTo(bar.x - cap, y); ctx.lineTo(bar.x + cap, y); }
          ctx.moveTo(bar.x, at(series.low[i]));
          ctx.lineTo(bar.x, at(series.high[i]));
          ctx.stroke();
        }
        if (!isDots) return;
        ctx.beginPath();
        ctx.arc(bar.x, at(series.y[i]), Math.min(4, 0.42 * bar.width), 0, 2 * Math.PI);
        ctx.fillStyle = series.hollow ? getComputedStyle(chart.canvas.closest('figure')).backgroundColor : paintOf(series);
        ctx.fill();
        ctx.lineWidth = 1.5;
        ctx.stroke();
      });
    };
    return {
      id: 'uprights',
      beforeDatasetsDraw: ({ ctx, chartArea, scales }) => {
        if (!plot.series.some((series) => series.mark === 'dots')) return;
        const step = chartArea.width / plot.x.names.length;
        ctx.save();
        ctx.fillStyle = `${ink}0a`;
        for (let place = 1; place < plot.x.names.length; place += 2)
          ctx.fillRect(scales.x.getPixelForValue(place) - step / 2, chartArea.top, step, chartArea.height);
        ctx.restore();
      },
      afterDatasetsDraw: (chart) => {
        chart.ctx.save();
        plot.series.forEach((series, k) => { if (isBeside(series)) draw(chart, series, k); });
        chart.ctx.restore();
      },
    };
  };

  // Room for what stands side by side: a figure with many takes the whole row, and is scrolled where that is too narrow.
  const makeRoom = (canvas, plot) => {
    const many = plot.x.names.length * Math.max(1, plot.series.filter(isBeside).length);
    if (many <= 40 && plot.x.names.length <= 20) return;
    canvas.closest('figure').classList.add('dense');
    const room = element('div');
    room.style.minWidth = `${60 + Math.max(8 * many, 14 * plot.x.names.length)}px`;
    canvas.replaceWith(room);
    room.append(canvas);
  };

  // Draws a plot that the program describes (show/plot/plot.h).
  const drawPlot = (canvas, plot) => {
    const { names } = plot.x;
    const placed = (x, values) => names.length
      ? names.map((_, place) => (x.includes(place) ? values[x.indexOf(place)] : null))
      : x.map((at, i) => ({ x: at, y: values[i] }));
    const datasets = plot.series.flatMap((series) => {
      const { dash, width } = series.style;
      const paint = paintOf(series);
      const beside = isBeside(series);
      const shape = beside ? { barPercentage: series.mark === 'dots' ? 1 : 0.9 } :
        { type: 'line', borderColor: paint, borderWidth: 1.5 * width, borderDash: dash, showLine: series.mark !== 'points', pointRadius: series.mark === 'line' ? 0 : 2.5 };
      const own = { label: series.name, data: placed(series.x, series.y), backgroundColor: series.mark === 'dots' ? 'transparent' : paint, ...shape };
      if (beside || !series.low.length) return [own];
      const bound = (values, fill) => ({ type: 'line', label: `_${series.name}`, data: placed(series.x, values), pointRadius: 0, borderWidth: 0, backgroundColor: `${paint}26`, fill });
      return [own, bound(series.high, '+1'), bound(series.low, false)];
    });
    const areBeside = plot.series.some(isBeside);
    const areDots = plot.series.some((series) => series.mark === 'dots');
    const labelColor = ({ datasetIndex }) => {
      const series = plot.series[datasetIndex];
      return { borderColor: paintOf(series), backgroundColor: series.hollow ? 'transparent' : paintOf(series) };
    };
    makeRoom(canvas, plot);
    return new Chart(canvas, {
      type: areBeside ? 'bar' : 'line',
      data: { labels: names.length ? names : undefined, datasets },
      options: {
        plugins: { legend: { display: false }, ...(areDots ? { tooltip: { callbacks: { labelColor } } } : {}) },
        // Dots are small to point at: what is said is said of their whole place.
        ...(areDots ? { interaction: { mode: 'index', intersect: false } } : {}),
        scales: { x: described(plot.x, []), y: described(plot.y, boundsOf(plot), plot.series.every(({ y }) => y.every(Number.isInteger))) },
      },
      plugins: areBeside ? [uprights(plot)] : [],
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

  // Says which one it is: the mark of its style, and its name.
  const named = (parent, { name, style }) => {
    parent.append(dotOf(style), document.createTextNode(name));
  };

  // Empties a table and gives it a heading; returns its body.
  const headed = (table, headings) => {
    table.replaceChildren();
    table.createTHead().insertRow().append(...headings.map((text) => element('th', text)));
    return table.createTBody();
  };

  // A table that is wider than its place becomes a list: a block for each row, with the heading beside each value.
  const fitted = new WeakSet();
  const fit = (table) => {
    const heads = [...table.tHead.rows[0].cells].map((cell) => cell.textContent.replace(/ [▲▼]$/, ''));
    for (const row of table.tBodies[0].rows) [...row.cells].forEach((cell, k) => { cell.dataset.name = heads[k] || ''; });
    const place = table.parentNode;
    const change = () => {
      table.classList.remove('stacked');
      table.classList.toggle('stacked', table.scrollWidth > place.clientWidth);
    };
    change();
    if (fitted.has(table)) return;
    fitted.add(table);
    let width = place.clientWidth;
    new ResizeObserver(() => { if (place.clientWidth !== width) { width = place.clientWidth; setTimeout(change); } }).observe(place);
  };

  // A table of what has a name and a style, which the first column shows, that a click on a heading sorts. A column has a name, what rows
  // are sorted by (`of`), and `up` where it begins ascending; a cell is draw(cell, row), text(row), or `of` with so many `digits`.
  const fill = (cell, row, { of, draw, text, digits }) => {
    if (draw) draw(cell, row); else cell.textContent = text ? text(row) : number(of(row), digits);
  };
  const sortable = (table, rows, columns, firstSort) => {
    let by = firstSort;
    let up = false;
    const draw = () => {
      table.replaceChildren();
      const head = table.createTHead().insertRow();
      columns.forEach((column, k) => {
        const sort = () => { up = k === by ? !up : Boolean(column.up); by = k; draw(); };
        const cell = element('th');
        cell.append(button(column.name + (k === by ? (up ? ' ▲' : ' ▼') : ''), sort));
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
        columns.forEach((column, k) => (k === 0 ? named(line.insertCell(), row) : fill(line.insertCell(), row, column)));
      }
      fit(table);
    };
    draw();
  };

  // A button that shows `player` on the whole screen; the key F does so for the player that the pointer is over.
  let pointed = null;
  const fullScreen = (player) => {
    const toggle = () => (document.fullscreenElement ? document.exitFullscreen() : player.requestFullscreen().catch(() => {}));
    player.addEventListener('pointerenter', () => { pointed = toggle; });
    player.addEventListener('pointerleave', () => { if (pointed === toggle) pointed = null; });
    return button('Full screen (F)', toggle);
  };
  document.addEventListener('keydown', (event) => {
    const isTyped = event.ctrlKey || event.metaKey || event.altKey || event.target.matches('select, input:not([type=range]):not([type=checkbox])');
    if (event.key.toLowerCase() === 'f' && pointed && !isTyped) pointed();
  });

  // The picture that the page holds under an id, decoded; null without one.
  const loaded = (id) => new Promise((done) => {
    const holder = byId(id);
    if (!holder) { done(null); return; }
    const image = new Image();
    image.onload = () => done(image);
    image.onerror = () => done(null);
    image.src = `data:image/jpeg;base64,${holder.textContent}`;
  });
  // Draws a box of the frame, which the canvas shows from (x, y) on, `margin` pixels of the canvas outside of it.
  const outline = (context, { x, y, scale }, [left, top, width, height], colour, thickness, dashes, margin = 1) => {
    context.setLineDash(dashes);
    context.strokeStyle = colour;
    context.lineWidth = thickness;
    context.strokeRect((left - x) * scale - margin, (top - y) * scale - margin, width * scale + 2 * margin, height * scale + 2 * margin);
  };

  // Lets a button play picture after picture, none before the one before it is drawn: go(index) draws one, next() is the index of the
  // next one, undefined after the last. Returns what stops it.
  const playable = (button, { go, next, pause_ms }) => {
    let playing = 0; // which call of play() goes on
    const stop = () => {
      playing += 1;
      button.textContent = 'Play';
    };
    const play = async () => {
      playing += 1;
      const mine = playing;
      button.textContent = 'Pause';
      if (next() === undefined) await go(0);
      while (mine === playing && next() !== undefined)
        await Promise.all([go(next()), new Promise((done) => setTimeout(done, pause_ms))]);
      if (mine === playing) stop();
    };
    button.addEventListener('click', () => (button.textContent === 'Play' ? play() : stop()));
    return stop;
  };

  const addChoice = (id, value, text) => {
    const option = element('option', text);
    option.value = value;
    byId(id).append(option);
  };
  // Adds values to a choice, each once and sorted.
  const choices = (id, values) => {
    for (const value of [...new Set(values)].sort()) addChoice(id, value, value);
  };

  // What both players of sequences begin with: the list of sequences, a box for each of `shown` that hides it, the buttons and the slider.
  //   sequences, wordsOf(one)   the list and what it says of each; each gets its index
  //   shown, hidden, redraw()   what can be hidden, the set of hidden indices, and what draws anew after a change of it
  //   show(index), current()    shows a sequence; the one that is shown
  //   go(index), stop()         the slider
  const beginPlayer = ({ sequences, wordsOf, shown, hidden, redraw, show, current, go, stop }) => {
    sequences.forEach((one, index) => {
      one.index = index;
      addChoice('sequence', index, wordsOf(one));
    });
    shown.forEach((one, k) => {
      const label = element('label');
      const box = element('input');
      box.type = 'checkbox';
      box.checked = true;
      box.addEventListener('change', () => {
        if (box.checked) hidden.delete(k); else hidden.add(k);
        redraw();
      });
      label.append(box);
      named(label, one);
      byId('shown').append(label);
    });
    byId('sequence').addEventListener('change', () => show(Number(byId('sequence').value)));
    const step = (by) => () => show((current().index + by + sequences.length) % sequences.length);
    byId('previous').addEventListener('click', step(-1));
    byId('next').addEventListener('click', step(1));
    byId('frame').addEventListener('input', () => { stop(); go(Number(byId('frame').value)); });
    byId('play').parentNode.append(fullScreen(byId('play').closest('.player')));
  };

  return {
    addChoice,
    aroundClosest,
    beginPlayer,
    button,
    byId,
    choices,
    ink,
    drawPlot,
    element,
    fit,
    fullScreen,
    headed,
    loaded,
    outline,
    playable,
    sortable,
    least: (values) => (values.length ? values.reduce((a, b) => Math.min(a, b)) : null),
    most: (values) => (values.length ? values.reduce((a, b) => Math.max(a, b)) : null),
    counted: (count, one, more = `${one}s`) => `${count.toLocaleString('en')} ${count === 1 ? one : more}`,
    named,
    number,
    line: (label, points, colour, more = {}) =>
      ({ label: shortened(label, 28), data: points, borderColor: colour, backgroundColor: colour, borderWidth: 1.5, pointRadius: 0, showLine: true, ...more }),
    axis: (text, more = {}) => ({ type: 'linear', title: { display: true, text }, ...more }),
    // Of the first ten of what is drawn: more names leave no room for the plot.
    legend: { position: 'top', labels: { boxWidth: 12, filter: (item) => !item.text.startsWith('_') && item.datasetIndex < 10 } },
  };
})();
