// SPDX-License-Identifier: Apache-2.0
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const { byId, counted, drawPlot, element, headed, ink, loaded, most, named, number, sortable, line, axis } = airtruth;
  const trackers = data.trackers;
  for (const tracker of trackers) Object.assign(tracker, { colour: tracker.style.colour, dash: tracker.style.dash });
  const scored = trackers.filter((tracker) => tracker.overall);

  // A bar over the interval and a mark at the mean, of `top`.
  const interval = (mean, bounds, top) => {
    const bar = element('span', '', 'range');
    const mark = element('b');
    mark.style.left = `${(98 * mean) / top}%`;
    if (bounds) {
      const span = element('i');
      span.style.left = `${(100 * bounds[0]) / top}%`;
      span.style.width = `${(100 * (bounds[1] - bounds[0])) / top}%`;
      bar.append(span);
      bar.title = `95 %: ${number(bounds[0], 3)} to ${number(bounds[1], 3)}`;
    }
    bar.append(mark);
    return bar;
  };

  const bracket = (name, digits) => (cell, row) => {
    const bounds = row.overall.intervals_95[name];
    cell.textContent = number(row.overall[name], digits);
    if (bounds) cell.title = `95 %: ${number(bounds[0], digits)} to ${number(bounds[1], digits)}`;
  };
  const drawRanking = () => {
    const top = most(scored.map((t) => (t.overall.intervals_95.auc || [0, t.overall.auc])[1])) || 1;
    const plain = (name, title, digits, up) => ({ name: title, digits, up, of: (t) => t.overall[name] });
    const measured = (name, title, digits, up) => ({ ...plain(name, title, digits, up), draw: bracket(name, digits) });
    sortable(byId('ranking'), scored, [
      { name: 'tracker', of: (t) => t.name, up: true },
      { name: 'sequences', of: (t) => t.sequences, digits: 0 },
      measured('auc', 'AUC', 3),
      { name: '95 %', of: (t) => t.overall.auc, draw: (cell, t) => cell.append(interval(t.overall.auc, t.overall.intervals_95.auc, top)) },
      measured('precision_20px', 'P@20', 3),
      measured('normalised_auc', 'NP', 3),
      measured('average_overlap', 'AO', 3),
      measured('success_50', 'SR50', 3),
      measured('centre_mean_px', 'centre, px', 1, true),
      plain('angle_mrad', 'mrad', 1, true),
      measured('x_rmse_px', 'x rmse, px', 1, true),
      measured('y_rmse_px', 'y rmse, px', 1, true),
      plain('sequences_lost', 'lost', 0, true),
      plain('frames_per_second_median', 'fps, median', 1),
      plain('frames_per_second', 'fps, mean', 1),
    ], 2);
    const vot = trackers.filter((t) => t.restart || t.multistart);
    if (!vot.length) return;
    byId('vot-place').hidden = false;
    const of = (part, name) => (t) => (t[part] ? t[part][name] : null);
    sortable(byId('vot'), vot, [
      { name: 'tracker', of: (t) => t.name, up: true },
      { name: 'restart: accuracy', of: of('restart', 'accuracy'), digits: 3 },
      { name: 'failures', of: of('restart', 'failures'), digits: 2, up: true },
      { name: 'reliability', of: of('restart', 'reliability'), digits: 3 },
      { name: `EAO [${data.eao_range}]`, of: of('restart', 'eao'), digits: 3 },
      { name: 'multi-start: accuracy', of: of('multistart', 'accuracy'), digits: 3 },
      { name: 'robustness', of: of('multistart', 'robustness'), digits: 3 },
      { name: `EAO [${data.eao_range}]`, of: of('multistart', 'eao'), digits: 3 },
    ], vot.some((t) => t.restart) ? 4 : 7);
  };

  const none = { display: false };

  // The plots are described by the program (evaluation/tracker_evaluation/page.h). They have no legends: the
  // ranking says which style is whose, and the caption which dash is of which protocol.
  const drawPlots = () => {
    for (const canvas of document.querySelectorAll('canvas[data-plot]')) {
      const plot = data.plots[canvas.dataset.plot];
      canvas.closest('figure').hidden = !plot;
      if (plot) drawPlot(canvas, plot);
    }
    const dashes = ['restart', 'multistart'].every((part) => trackers.some((t) => t[part])) ? '; full: restart, dashed: multi-start' : '';
    byId('eao-caption').textContent = `Expected average overlap by length; the score is the mean over ${data.eao_range.join(' to ')} frames${dashes}`;
  };

  const drawPairs = () => {
    if (!data.comparisons.length) { byId('pairs-place').hidden = true; return; }
    const body = headed(byId('pairs'), ['', ...scored.map((t) => t.name)]);
    for (const a of scored) {
      const row = body.insertRow();
      named(row.insertCell(), a);
      for (const b of scored) {
        const cell = row.insertCell();
        const found = data.comparisons.find((c) => (c.a === a.name && c.b === b.name) || (c.a === b.name && c.b === a.name));
        if (!found || !found.sequences) continue;
        const sign = found.a === a.name ? 1 : -1;
        const bounds = found.interval_95 && (sign > 0 ? found.interval_95 : [-found.interval_95[1], -found.interval_95[0]]);
        const sure = bounds && (bounds[0] > 0 || bounds[1] < 0);
        const text = `${sign * found.auc_difference >= 0 ? '+' : '−'}${number(Math.abs(found.auc_difference), 3)}`;
        cell.append(element(sure ? 'b' : 'span', text));
        if (bounds) cell.append(document.createTextNode(` [${number(bounds[0], 3)}, ${number(bounds[1], 3)}]`));
        cell.append(document.createTextNode(` p ${number(found.p_value, 3)}`));
        cell.title = `better in ${sign > 0 ? found.wins : found.losses} of ${found.sequences}`;
      }
    }
  };

  // One sequence at a time: three charts over the frames, and the player; all show one frame.
  const player = (() => {
    const hidden = new Set();
    let sequence = null;
    let at = 0; // index into the sequence's series
    let charts = [];
    let asked = 0;

    const cursor = {
      id: 'cursor',
      afterDatasetsDraw: (chart) => {
        if (!sequence) return;
        const x = chart.scales.x.getPixelForValue(sequence.frame[at]);
        const { top, bottom } = chart.chartArea;
        chart.ctx.save();
        chart.ctx.strokeStyle = Chart.defaults.color;
        chart.ctx.beginPath();
        chart.ctx.moveTo(x, top);
        chart.ctx.lineTo(x, bottom);
        chart.ctx.stroke();
        chart.ctx.restore();
      },
    };

    const middle = (box, side) => (box ? box[side] + box[side + 2] / 2 : null);
    const shownTrackers = () => sequence.trackers.filter((one) => !hidden.has(one.tracker));
    const trackerOf = (one) => trackers[one.tracker];

    const drawSeries = () => {
      charts.forEach((chart) => chart.destroy());
      const points = (values) => values.map((y, i) => ({ x: sequence.frame[i], y }));
      const of = (boxes, side) => points(boxes.map((box) => middle(box, side)));
      const lineOf = (one, values) => line(trackerOf(one).name, values, trackerOf(one).colour, { borderWidth: 1.3, borderDash: trackerOf(one).dash });
      const series = (id, side, title) => {
        const sets = [line('truth', of(sequence.truth, side), ink, { borderWidth: 3.5, order: 1 })];
        for (const one of shownTrackers()) sets.push(lineOf(one, of(one.boxes, side)));
        return [id, sets, axis(title)];
      };
      const distance = (one) => points(sequence.truth.map((box, i) =>
        box && one.boxes[i] ? Math.hypot(middle(one.boxes[i], 0) - middle(box, 0), middle(one.boxes[i], 1) - middle(box, 1)) : null));
      const errors = shownTrackers().map((one) => lineOf(one, distance(one)));
      charts = [series('x', 0, 'X of the centre, px'), series('y', 1, 'Y of the centre, px'), ['error', errors, axis('centre error, px', { beginAtZero: true })]].map(
        ([id, sets, y]) =>
          new Chart(byId(id), {
            type: 'scatter',
            data: { datasets: sets },
            options: {
              spanGaps: false,
              events: [],
              plugins: { legend: none, tooltip: { enabled: false } },
              scales: { x: axis(id === 'error' ? 'frame' : '', { min: sequence.frame[0], max: sequence.frame[sequence.frame.length - 1] }), y: { ...y, afterFit: (scale) => { scale.width = 58; } } },
            },
            plugins: [cursor],
          }));
    };

    // Where there are pictures, the cursor rests on frames that have one: what is shown is always the
    // frame that is named, with the boxes of that frame.
    const nearestStill = (index) =>
      sequence.stills.reduce((best, still) => (Math.abs(still.at - index) < Math.abs(best.at - index) ? still : best), sequence.stills[0]);

    const drawPicture = (canvas, image, still, x, y, px) => {
      const context = canvas.getContext('2d');
      context.clearRect(0, 0, canvas.width, canvas.height);
      if (!image) return;
      context.drawImage(image, 0, 0, canvas.width, canvas.height);
      const outline = (box, ...style) => { if (box) airtruth.outline(context, { x, y, scale: canvas.width / px }, box, ...style); };
      outline(sequence.truth[still.at], '#000000', 4.5, []);
      outline(sequence.truth[still.at], '#ffffff', 2, []);
      for (const one of shownTrackers()) outline(one.boxes[still.at], trackerOf(one).colour, 1.8, trackerOf(one).dash);
    };

    const captionOf = (index) => {
      const parts = [`frame ${sequence.frame[index]}`];
      if (sequence.range_m[index] !== null) parts.push(`range ${number(sequence.range_m[index])} m`);
      if (sequence.truth[index]) parts.push(`${number(sequence.truth[index][2])} × ${number(sequence.truth[index][3])} px`);
      else parts.push('not seen');
      if (!sequence.stills.length) parts.push('no pictures');
      return parts.join(', ');
    };
    // Pictures, caption, slider and cursors change together, once the pictures are decoded.
    const drawFrame = async () => {
      asked += 1;
      const mine = asked;
      const index = at;
      const still = sequence.stills.length ? nearestStill(index) : null;
      const name = still ? `${sequence.index}-${still.number}` : '';
      const [whole, close] = still ? await Promise.all([loaded(`whole-${name}`), loaded(`close-${name}`)]) : [null, null];
      if (mine !== asked) return;
      byId('whole').height = Math.round((800 * sequence.height) / sequence.width);
      drawPicture(byId('whole'), whole, still, 0, 0, sequence.width);
      drawPicture(byId('close'), close, still, still && still.close_x, still && still.close_y, still && still.close_px);
      byId('caption').textContent = captionOf(index);
      byId('frame').value = index;
      charts.forEach((chart) => chart.draw());
    };

    const go = (index) => {
      const inside = Math.max(0, Math.min(sequence.frame.length - 1, index));
      at = sequence.stills.length ? nearestStill(inside).at : inside;
      return drawFrame();
    };
    const stop = airtruth.playable(byId('play'), { go, next: () => sequence.stills.find((still) => still.at > at)?.at, pause_ms: 100 });

    const drawTable = () => {
      const body = headed(byId('losses'), ['tracker', 'AUC', 'P@20', 'mrad', 'first loss']);
      for (const one of sequence.trackers) {
        const row = body.insertRow();
        named(row.insertCell(), trackerOf(one));
        const lost = one.first_loss
          ? `frame ${one.first_loss.frame}${one.first_loss.range_m === null ? '' : `, ${number(one.first_loss.range_m)} m`}`
          : 'never';
        for (const text of [number(one.auc, 3), number(one.precision_20px, 3), number(one.angle_mrad, 1), lost]) row.append(element('td', text));
      }
      airtruth.fit(byId('losses'));
    };

    const show = (index) => {
      stop();
      sequence = data.sequences[index];
      byId('sequence').value = index;
      byId('frame').max = sequence.frame.length - 1;
      byId('facts').textContent = `over ${sequence.background}, ${counted(sequence.frames, 'frame')} of ${sequence.width} × ${sequence.height}` +
        (sequence.trackers.length ? '' : '; no tracker has results for it');
      at = 0;
      drawSeries();
      drawTable();
      go(0);
    };

    const seek = (event) => {
      const chart = charts.find((c) => c.canvas === event.currentTarget);
      if (!chart) return;
      const frame = chart.scales.x.getValueForPixel(event.offsetX);
      let best = 0;
      sequence.frame.forEach((f, i) => { if (Math.abs(f - frame) < Math.abs(sequence.frame[best] - frame)) best = i; });
      stop();
      go(best);
    };

    const begin = () => {
      const redraw = () => { drawSeries(); drawFrame(); };
      airtruth.beginPlayer({
        sequences: data.sequences, wordsOf: (one) => (one.trackers.length ? one.name : `${one.name} (no results)`),
        shown: trackers, hidden, redraw, show, current: () => sequence, go, stop,
      });
      for (const id of ['x', 'y', 'error']) {
        byId(id).addEventListener('pointermove', seek);
        byId(id).addEventListener('pointerdown', seek);
      }
      if (!data.sequences.length) return;
      const first = data.sequences.find((one) => one.trackers.length && one.stills.length) || data.sequences.find((one) => one.trackers.length);
      show(first ? first.index : 0);
    };
    return { begin };
  })();

  byId('title').textContent = `Trackers on ${data.dataset}`;
  document.title = byId('title').textContent;
  byId('summary').textContent = `${counted(trackers.length, 'tracker')}, ${counted(data.sequences.length, 'sequence')}, ${counted(data.frames, 'frame')}; made by airtruth ${data.version}`;
  drawRanking();
  drawPlots();
  drawPairs();
  player.begin();
})();
