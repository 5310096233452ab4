// SPDX-License-Identifier: Apache-2.0
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const { byId, choices, counted, drawPlot, element, least, loaded, most, number, outline, line, axis, legend } = airtruth;
  const { encounters } = airtruth;
  const { colours } = data;

  // What a sequence is sorted and filtered by: over the frames that show an intruder.
  data.sequences.forEach((sequence, index) => {
    sequence.index = index;
    [sequence.nearest, sequence.farthest] = sequence.range_m;
    [sequence.smallest, sequence.largest] = sequence.size_px;
    encounters.addKeys(sequence);
  });
  // How what is inserted departs from the clip: the keys that any sequence states.
  const weatherKeys = [...new Set(data.sequences.flatMap((s) => Object.keys(s.weather)))].sort();
  for (const sequence of data.sequences)
    for (const key of weatherKeys) sequence[key] = key in sequence.weather ? sequence.weather[key] : null;

  const drawOverview = () => {
    byId('title').textContent = data.title;
    document.title = data.title;
    const spread = data.sequences.length < data.count ? `, of which ${data.sequences.length} are shown below` : '';
    const missing = data.missing > 0 ? `, ${counted(data.missing, 'sequence')} missing` : '';
    byId('summary').textContent =
      `${counted(data.count, 'sequence')}, ${counted(data.frames, 'frame')}${missing}${spread}; ` +
      `negatives: ${counted(data.negative_sequences, 'sequence')} and ${counted(data.frames - data.frames_with_intruder, 'frame')} show no intruder; ` +
      `in view by geometry and without a box: ${number(data.without_box)}`;
    for (const [key, value] of Object.entries(data.card)) {
      byId('card').append(element('dt', key), element('dd', String(value)));
    }
    // The bar charts are described by the program (dataset/set_report/totals.h).
    for (const canvas of document.querySelectorAll('canvas[data-plot]')) {
      const plot = data.plots[canvas.dataset.plot];
      if (plot) drawPlot(canvas, plot); else canvas.closest('figure').remove();
    }
    drawCentres();
  };

  // A cell is as dark as it has boxes (square root); the picture's upper left corner is the plot's.
  const drawCentres = () => {
    const { columns, rows, counts } = data.centres;
    const top = most(counts) || 0;
    byId('most').textContent = `; darkest: ${counted(top, 'box', 'boxes')} of ${number(counts.reduce((a, b) => a + b, 0))}`;
    const cells = {
      id: 'cells',
      beforeDatasetsDraw: (chart) => {
        const { left, top: above, width, height } = chart.chartArea;
        counts.forEach((count, i) => {
          if (!count) return;
          chart.ctx.globalAlpha = 0.15 + 0.85 * Math.sqrt(count / top);
          chart.ctx.fillStyle = colours[0];
          const [x, y] = [i % columns, Math.floor(i / columns)];
          chart.ctx.fillRect(left + (x * width) / columns, above + (y * height) / rows, width / columns + 0.5, height / rows + 0.5);
        });
        chart.ctx.globalAlpha = 1;
      },
    };
    const share = (more) => ({ type: 'linear', min: 0, max: 100, ticks: { stepSize: 25 }, ...more });
    new Chart(byId('centres'), {
      type: 'scatter',
      data: { datasets: [{ data: [] }] },
      options: { events: [], plugins: { legend: { display: false }, tooltip: { enabled: false } }, scales: { x: share({ position: 'bottom' }), y: share({ reverse: true }) } },
      plugins: [cells],
    });
  };

  const scatter = (canvas, datasets, scales) => new Chart(canvas, { type: 'scatter', data: { datasets }, options: { plugins: { legend }, scales } });

  // From above, one scale for both axes, with the camera's view at the first frame and the closest approaches.
  const planView = (canvas, sequence) => {
    const camera = sequence.camera;
    const plan = encounters.planOf(sequence, encounters.isCourseUp());
    const sets = [line('camera', camera.east_m.map((east, i) => plan.at(east, camera.north_m[i])), '#7d8590')];
    sequence.intruders.forEach((intruder, k) => {
      const points = intruder.east_m.map((east, i) => (east === null ? null : plan.at(east, intruder.north_m[i]))).filter(Boolean);
      if (!points.length) return;
      sets.push(line(intruder.id, points, colours[k % colours.length]));
      sets.push(line('_start', [points[0]], colours[k % colours.length], { pointRadius: 3 }));
    });
    sets.push(...encounters.marksOn(sequence, plan));
    const all = sets.flatMap((s) => s.data);
    let [west, east] = [least(all.map((p) => p.x)), most(all.map((p) => p.x))];
    let [south, north] = [least(all.map((p) => p.y)), most(all.map((p) => p.y))];
    const reach = 0.9 * Math.max(east - west, north - south, 50);
    if (sequence.fov_deg) {
      const at = plan.at(camera.east_m[0], camera.north_m[0]);
      const half = Math.min(sequence.fov_deg, 359) / 2;
      const arm = (degrees) => {
        const angle = ((camera.yaw_deg[0] + degrees) * Math.PI) / 180;
        return plan.at(camera.east_m[0] + reach * Math.sin(angle), camera.north_m[0] + reach * Math.cos(angle));
      };
      sets.push(line('view', [arm(-half), at, arm(half)], '#7d8590', { borderDash: [5, 4], borderWidth: 1 }));
    }
    const shown = sets.filter((s) => s.label !== 'view').flatMap((s) => s.data);
    west = least(shown.map((p) => p.x)); east = most(shown.map((p) => p.x));
    south = least(shown.map((p) => p.y)); north = most(shown.map((p) => p.y));
    const aspect = Math.max(0.4, (canvas.parentNode.clientWidth - 60) / (canvas.parentNode.clientHeight - 80));
    const tall = Math.max((north - south) * 1.15, ((east - west) * 1.15) / aspect, 20);
    const wide = tall * aspect;
    const about = (middle, length) => ({ min: middle - length / 2, max: middle + length / 2, ticks: { maxTicksLimit: 7, callback: (v) => number(v) } });
    return scatter(canvas, sets, { x: axis(plan.x, about((west + east) / 2, wide)), y: axis(plan.y, about((south + north) / 2, tall)) });
  };

  const profile = (canvas, sequence) => {
    const camera = sequence.camera;
    const sets = [line('camera height, m', camera.frame.map((x, i) => ({ x, y: -camera.down_m[i] })), '#7d8590')];
    sequence.intruders.forEach((intruder, k) =>
      sets.push(line(`${intruder.id} height, m`, intruder.frame.map((x, i) => ({ x, y: intruder.down_m[i] === null ? null : -intruder.down_m[i] })), colours[k % colours.length])));
    // Of a motion that is a rotation alone there is no shift.
    const hasShift = camera.shift_px.some((shift) => shift);
    if (hasShift) sets.push(line('camera shift, px', camera.frame.map((x, i) => ({ x, y: camera.shift_px[i] })), '#B8B000', { yAxisID: 'shift', borderWidth: 1 }));
    const shift = hasShift ? { shift: axis('shift, px', { position: 'right', beginAtZero: true, grid: { display: false } }) } : {};
    return scatter(canvas, sets, { x: axis('frame'), y: axis('height, m'), ...shift });
  };

  const sizes = (canvas, sequence) => {
    const sets = [];
    const frames = sequence.intruders.flatMap((intruder) => intruder.frame);
    const range = { min: least(frames) ?? 0, max: most(frames) ?? 1 };
    sequence.intruders.forEach((intruder, k) => {
      const colour = colours[k % colours.length];
      sets.push(line(`${intruder.id} range, m`, intruder.frame.map((x, i) => ({ x, y: intruder.range_m[i] })), colour));
      sets.push(line('width, px', intruder.frame.map((x, i) => ({ x, y: intruder.width_px[i] })), colour, { yAxisID: 'px', borderDash: [4, 3] }));
      sets.push(line('height, px', intruder.frame.map((x, i) => ({ x, y: intruder.height_px[i] })), colour, { yAxisID: 'px', borderDash: [2, 3] }));
    });
    const px = axis('box, px', { position: 'right', beginAtZero: true, grid: { display: false } });
    return scatter(canvas, sets, { x: axis('frame', range), ...encounters.axisOf(sequence, range), y: axis('range, m', { beginAtZero: true }), px });
  };

  const address = (path) => path.split('/').map(encodeURIComponent).join('/');

  // Plays the frames that the page holds, each with its number and boxes; and, where the browser knows its
  // format and it is still where it was, the video file itself.
  const playerOf = (sequence) => {
    const place = element('div', undefined, 'film');
    const canvas = element('canvas');
    canvas.width = Math.min(960, Math.max(640, sequence.width));
    canvas.height = Math.max(1, Math.round((canvas.width * sequence.height) / sequence.width));
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', `Frames of ${sequence.name}`);
    const controls = element('div', undefined, 'scrub');
    const button = element('button', 'Play');
    button.type = 'button';
    const slider = element('input');
    slider.type = 'range';
    slider.min = 0;
    slider.max = Math.max(0, sequence.stills.length - 1);
    slider.setAttribute('aria-label', 'Frame');
    controls.append(button, slider);
    const caption = element('p', '', 'note');
    place.append(canvas, controls, caption);
    const zoom = element('canvas');
    zoom.width = zoom.height = 480;
    zoom.setAttribute('role', 'img');
    zoom.setAttribute('aria-label', `The intruder of ${sequence.name}, enlarged`);
    let at = sequence.poster;
    let asked = 0;

    // The part of the frame from (left, top) on, `px` wide, with its boxes; without an image nothing.
    const draw = (on, image, boxes, left, top, px) => {
      const context = on.getContext('2d');
      context.clearRect(0, 0, on.width, on.height);
      if (!image) return;
      context.drawImage(image, 0, 0, on.width, on.height);
      for (const [intruder, ...box] of boxes)
        for (const [colour, thickness] of [['#000000', 3.5], [colours[intruder % colours.length], 1.8]])
          outline(context, { x: left, y: top, scale: on.width / px }, box, colour, thickness, [], 2);
    };
    // Pictures, boxes, caption and slider change together, once the pictures are decoded.
    const show = async (index) => {
      at = index;
      asked += 1;
      const mine = asked;
      const still = sequence.stills[index];
      const [whole, close] = await Promise.all([loaded(`whole-${sequence.index}-${index}`), loaded(`close-${sequence.index}-${index}`)]);
      if (mine !== asked) return;
      draw(canvas, whole, still.boxes, 0, 0, sequence.width);
      draw(zoom, close, still.boxes, ...(still.zoom || [0, 0, 1]));
      caption.textContent = `frame ${still.frame}` + (still.boxes.length ? '' : ', no intruder is seen');
      slider.value = index;
    };
    const stop = airtruth.playable(button, {
      go: show, next: () => (at + 1 < sequence.stills.length ? at + 1 : undefined),
      pause_ms: Math.max(40, Math.min(400, (1000 * sequence.seconds) / Math.max(1, sequence.stills.length))),
    });
    slider.addEventListener('input', () => { stop(); show(Number(slider.value)); });

    const addFile = () => {
      const open = airtruth.button('Play the file', () => {
        stop();
        const video = element('video');
        video.controls = true;
        video.muted = true;
        video.playsInline = true;
        video.addEventListener('error', () => {
          video.replaceWith(canvas);
          controls.hidden = false;
          open.remove();
          caption.textContent = 'the video file is not beside this page, or of no format that this browser plays';
        });
        video.src = address(sequence.video);
        canvas.replaceWith(video);
        controls.hidden = true;
        caption.textContent = 'the video file, every frame; without boxes';
        video.play().catch(() => {});
      });
      controls.append(open);
    };
    const begin = () => {
      if (!sequence.stills.length) { place.replaceChildren(element('p', 'no pictures', 'note')); return; }
      if (sequence.video) addFile();
      show(at);
    };
    return { place, zoom, controls, begin };
  };

  const link = (path) => {
    const a = element('a', path.split('/').pop());
    a.href = address(path);
    return a;
  };

  // The frame of a card is made at once; what costs is drawn when it comes into view.
  const cardOf = (sequence) => {
    const card = element('article', undefined, 'sequence');
    card.append(element('h2', sequence.name));
    const light = sequence.sun_elevation_deg === null ? '' :
      ` · sun ${number(sequence.sun_azimuth_deg)}° / ${number(sequence.sun_elevation_deg)}° high`;
    card.append(element('p',
      `${sequence.aircraft.join(', ') || (sequence.visible ? 'nothing labelled' : 'no intruder (a negative)')} over ${sequence.background} · ${counted(sequence.frames, 'frame')}, ${number(sequence.seconds, 1)} s, ` +
      `${sequence.width}×${sequence.height} · seen in ${number(sequence.visible)}, hidden in ${number(sequence.hidden)} · ` +
      (sequence.visible && sequence.nearest !== null ? `range ${number(sequence.nearest)}–${number(sequence.farthest)} m · ` : '') +
      (sequence.visible ? `box ${number(sequence.smallest)}–${number(sequence.largest)} px · ` : '') +
      `contrast ${number(sequence.contrast, 1)}${light}${sequence.motion_model ? ` · motion: ${sequence.motion_model}` : ''}`));
    const table = encounters.tableOf(sequence, colours);
    if (table) card.append(table);
    const row = element('div', undefined, 'row');
    const pictures = element('div');
    const player = playerOf(sequence);
    const film = element('div', undefined, 'player');
    const pair = element('div', undefined, 'pair');
    const loop = element('div', undefined, 'loop');
    loop.setAttribute('role', 'img');
    loop.setAttribute('aria-label', 'The intruder, enlarged');
    const links = element('div', undefined, 'links');
    sequence.files.forEach((path) => links.append(link(path)));
    pair.append(loop, links);
    pictures.append(player.zoom, pair);
    film.append(player.place, pictures);
    player.controls.append(airtruth.fullScreen(film));
    card.append(film);
    const plots = ['plan', 'profile', 'sizes'].map(() => {
      const plot = element('div', undefined, 'plot');
      plot.append(element('canvas'));
      row.append(plot);
      return plot.firstChild;
    });
    card.append(row);
    card.draw = () => {
      player.begin();
      if (table) airtruth.fit(table.firstChild);
      const strip = byId(`loop-${sequence.index}`);
      if (strip) {
        const side = sequence.loop_side;
        loop.style.backgroundImage = `url(data:image/jpeg;base64,${strip.textContent})`;
        if (sequence.loop_frames > 1)
          loop.animate(
            [{ backgroundPosition: '0 0' }, { backgroundPosition: `${-side * sequence.loop_frames}px 0` }],
            { duration: 220 * sequence.loop_frames, easing: `steps(${sequence.loop_frames})`, iterations: Infinity });
      } else loop.remove();
      if (sequence.camera.frame.length) {
        card.plan = planView(plots[0], sequence);
        profile(plots[1], sequence);
      } else plots.slice(0, 2).forEach((p) => p.parentNode.replaceChildren(element('span', 'imported: no geometry', 'none')));
      sizes(plots[2], sequence);
      card.draw = null;
    };
    return card;
  };

  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries)
      if (entry.isIntersecting && entry.target.draw) entry.target.draw();
  }, { rootMargin: '200px' });

  const cards = data.sequences.map(cardOf);

  // Plans that are drawn turn with the choice of what is up; the others are drawn so.
  let courseUp = encounters.isCourseUp();
  const turnPlans = () => {
    if (courseUp === encounters.isCourseUp()) return;
    courseUp = encounters.isCourseUp();
    for (const card of cards) {
      if (!card.plan) continue;
      const { canvas } = card.plan;
      card.plan.destroy();
      card.plan = planView(canvas, data.sequences[cards.indexOf(card)]);
    }
  };

  const list = () => {
    turnPlans();
    const find = byId('find').value.toLowerCase();
    const limit = (id, otherwise) => (byId(id).value === '' ? otherwise : Number(byId(id).value));
    const [from, to] = [limit('nearest-from', -Infinity), limit('nearest-to', Infinity)];
    const limited = byId('nearest-from').value !== '' || byId('nearest-to').value !== '';
    const weather = weatherKeys.length ? byId('weather').value : '';
    const [weatherFrom, weatherTo] = weather ? [limit('weather-from', -Infinity), limit('weather-to', Infinity)] : [];
    const key = byId('sort').value;
    const shown = data.sequences.filter((s) =>
      s.name.toLowerCase().includes(find) &&
      (!byId('aircraft').value || s.aircraft.includes(byId('aircraft').value)) &&
      (!byId('shows').value || (byId('shows').value === 'some') === s.visible > 0) &&
      (!byId('background').value || s.background === byId('background').value) &&
      encounters.matches(s) &&
      (!weather || (s[weather] !== null && s[weather] >= weatherFrom && s[weather] <= weatherTo)) &&
      (!limited || (s.nearest !== null && s.nearest >= from && s.nearest <= to)));
    const order = byId('descending').checked ? -1 : 1;
    // What has no such number comes last, whichever way.
    shown.sort((a, b) => {
      if (key === 'name') return order * a.name.localeCompare(b.name, 'en', { numeric: true });
      if (a[key] === null || b[key] === null) return (a[key] === null) - (b[key] === null);
      return order * (a[key] - b[key]);
    });
    byId('sequences').replaceChildren(...shown.map((s) => cards[s.index]));
    byId('count').textContent = `${number(shown.length)} of ${number(cards.length)}`;
  };

  drawOverview();
  choices('aircraft', data.sequences.flatMap((s) => s.aircraft));
  choices('background', data.sequences.map((s) => s.background));
  encounters.begin(data.sequences);
  choices('weather', weatherKeys);
  choices('sort', weatherKeys);
  if (!weatherKeys.length) byId('of-weather').remove();
  byId('filters').addEventListener('input', list);
  list();
  cards.forEach((card) => seen.observe(card));
})();
