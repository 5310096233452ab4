// SPDX-License-Identifier: Apache-2.0
'use strict';
// Plays the sequences of an evaluation of detectors: pictures that the page holds, with truth, detections and
// tracks, and a strip over all frames.
airtruth.detectionPlayer = (data) => {
  const { aroundClosest, byId, counted, element, headed, ink, loaded, named, number, outline } = airtruth;
  const { detectors } = data;
  const hidden = new Set();
  let sequence = null;
  let at = 0; // index into the sequence's stills
  let asked = 0;

  const shown = () => sequence.detectors.filter((one) => !hidden.has(one.detector));
  const isStrong = (detector, score) => score >= detectors[detector].point.score;

  const cross = (context, view, [x, y, width, height]) => {
    const [left, top, right, bottom] = [x - view.x, y - view.y, x + width - view.x, y + height - view.y].map((v) => v * view.scale);
    context.setLineDash([]);
    context.beginPath();
    context.moveTo(left, top);
    context.lineTo(right, bottom);
    context.moveTo(right, top);
    context.lineTo(left, bottom);
    context.stroke();
  };
  const drawTruth = (context, view, still) => {
    for (const box of still.ignored) outline(context, view, box, '#9aa7b4', 1.5, [2, 3]);
    for (const object of still.objects) {
      const isAircraft = object.class === 'aircraft' && object.counts;
      outline(context, view, object.box, '#000000', 4.5, []);
      outline(context, view, object.box, isAircraft ? '#ffffff' : '#9aa7b4', 2, isAircraft ? [] : [2, 3]);
    }
  };
  // Where a track was in the pictures before this one, as far as it was drawn in them.
  const trailLength = 12;
  const drawTrail = (context, view, one, track) => {
    context.setLineDash([]);
    context.globalAlpha = 0.7;
    context.lineWidth = 1.2;
    context.beginPath();
    let isOpen = false;
    for (let k = Math.max(0, at - trailLength); k <= at; ++k) {
      const found = one.drawn[k].find((detection) => detection[2] === track);
      if (!found) continue;
      const [x, y, width, height] = found[0];
      const [px, py] = [(x + width / 2 - view.x) * view.scale, (y + height / 2 - view.y) * view.scale];
      if (isOpen) context.lineTo(px, py); else context.moveTo(px, py);
      isOpen = true;
    }
    context.stroke();
    context.globalAlpha = 1;
  };
  const drawDetections = (context, view) => {
    for (const one of shown()) {
      const { colour } = detectors[one.detector].style;
      for (const [box, score, track, fate] of one.drawn[at]) {
        const strong = isStrong(one.detector, score);
        if (!strong && !byId('weak').checked) continue;
        outline(context, view, box, colour, 1.8, strong ? [] : [5, 4]);
        if (fate === 'false alarm' && strong) cross(context, view, box);
        if (track === null) continue;
        drawTrail(context, view, one, track);
        context.fillStyle = colour;
        context.font = 'bold 13px system-ui, sans-serif';
        context.fillText(String(track), (box[0] - view.x + box[2]) * view.scale + 3, (box[1] - view.y) * view.scale);
      }
    }
  };
  const drawPicture = (canvas, image, view, still) => {
    const context = canvas.getContext('2d');
    context.clearRect(0, 0, canvas.width, canvas.height);
    if (!image) return;
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    drawTruth(context, view, still);
    drawDetections(context, view);
  };

  const captionOf = (still) => {
    if (!still) return 'no pictures';
    const parts = [`frame ${still.frame}, ${number(still.time_s, 2)} s`];
    const aircraft = still.objects.filter((object) => object.class === 'aircraft');
    if (!aircraft.length) parts.push('no aircraft');
    for (const object of aircraft) {
      const facts = [`${number(object.box[2])} × ${number(object.box[3])} px`];
      if (object.range_m !== null) facts.push(`${number(object.range_m)} m`);
      if (object.to_closest_s !== null) facts.push(aroundClosest(object.to_closest_s));
      if (object.cnr !== null) facts.push(`contrast to noise ${number(object.cnr, 1)}`);
      parts.push(facts.join(', '));
    }
    return parts.join('; ');
  };

  // The detections of the picture, the strongest first.
  const mostRows = 8;
  const drawTable = () => {
    const body = headed(byId('boxes'), ['detector', 'score', 'track', 'fate']);
    for (const one of shown()) {
      const listed = (one.drawn[at] || []).filter(([, score]) => isStrong(one.detector, score) || byId('weak').checked);
      for (const [, score, track, fate, what] of listed.slice(0, mostRows)) {
        const row = body.insertRow();
        named(row.insertCell(), detectors[one.detector]);
        const said = fate === 'found' || what === '' ? fate : `${fate}: ${what}`;
        for (const text of [number(score, 3), track === null ? '–' : String(track), said]) row.append(element('td', text));
      }
      if (listed.length > mostRows) body.insertRow().append(element('td', `and ${listed.length - mostRows} more`));
    }
    airtruth.fit(byId('boxes'));
  };

  const rowHeight = 18;
  const drawStrip = () => {
    const canvas = byId('strip');
    const rows = shown();
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(100, canvas.parentNode.clientWidth - 28);
    const height = Math.max(1, rows.length) * rowHeight + 4;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    canvas.style.height = `${height}px`;
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    const count = sequence.frame.length;
    const place = (index) => (index * width) / count;
    rows.forEach((one, k) => {
      const top = k * rowHeight + 2;
      const { colour } = detectors[one.detector].style;
      for (let i = 0; i < count;) {
        const letter = one.found[i];
        let end = i + 1;
        while (end < count && one.found[end] === letter) ++end;
        if (letter !== '.') {
          context.fillStyle = letter === 'm' ? '#9aa7b455' : colour;
          const tall = letter === 'p' ? 5 : 10;
          context.fillRect(place(i), top + 10 - tall, Math.max(0.5, place(end) - place(i)), tall);
        }
        i = end;
      }
      context.fillStyle = ink;
      context.globalAlpha = 0.55;
      for (const index of one.false_alarms) context.fillRect(place(index), top + 11.5, Math.max(1, width / count), 3);
      context.globalAlpha = 1;
    });
    const still = sequence.stills[at];
    if (!still) return;
    context.fillStyle = ink;
    context.fillRect(place(still.index + 0.5) - 0.75, 0, 1.5, height);
  };

  // Pictures, caption, table, slider and strip change together, once the pictures are decoded.
  const drawFrame = async () => {
    asked += 1;
    const mine = asked;
    const still = sequence.stills[at];
    const name = `${sequence.index}-${at}`;
    const [whole, close] = still ? await Promise.all([loaded(`whole-${name}`), loaded(`close-${name}`)]) : [null, null];
    if (mine !== asked) return;
    byId('whole').height = Math.round((byId('whole').width * sequence.height) / sequence.width);
    drawPicture(byId('whole'), whole, { x: 0, y: 0, scale: byId('whole').width / sequence.width }, still);
    const [x, y, px] = (still && still.close) || [0, 0, 1];
    drawPicture(byId('close'), close, { x, y, scale: byId('close').width / px }, still);
    byId('caption').textContent = captionOf(still);
    byId('frame').value = at;
    drawTable();
    drawStrip();
  };

  const go = (index) => {
    at = Math.max(0, Math.min(sequence.stills.length - 1, index));
    return drawFrame();
  };
  const stop = airtruth.playable(byId('play'), { go, next: () => (at + 1 < sequence.stills.length ? at + 1 : undefined), pause_ms: 120 });

  const factsOf = () => {
    const parts = [`over ${sequence.background}, ${counted(sequence.frame.length, 'frame')} of ${sequence.width} × ${sequence.height}`];
    for (const one of sequence.encounters) {
      if (one.closest_s === null) continue;
      const violation = one.violation_s === null || !data.volume ? '' : `, violates ${data.volume} from ${number(one.violation_s, 1)} s`;
      parts.push(`${one.name}: closest ${number(one.closest_m)} m at ${number(one.closest_s, 1)} s${violation}`);
    }
    // When each detector has declared each aircraft.
    detectors.forEach((detector) => {
      for (const one of detector.tracks ? detector.tracks.encounters : []) {
        if (one.sequence !== sequence.name) continue;
        const { declaration } = one;
        const range = declaration && declaration.range_m !== null ? ` at ${number(declaration.range_m)} m` : '';
        const time = declaration && declaration.to_closest_approach_s !== null ? `, ${aroundClosest(declaration.to_closest_approach_s)}` : '';
        parts.push(`${detector.name} ${declaration ? `declares ${one.name || one.object}${range}${time}` : `never declares ${one.name || one.object}`}`);
      }
    });
    if (data.is_weighted) parts.push(`weight ${number(sequence.weight, 3)}`);
    if (!sequence.detectors.length) parts.push('no detector has results for it');
    return parts.join(' · ');
  };

  const nearestStill = (index) => sequence.stills.reduce(
    (best, still, k) => (Math.abs(still.index - index) < Math.abs(sequence.stills[best].index - index) ? k : best), 0);

  const show = (index, frameIndex = 0) => {
    stop();
    sequence = data.sequences[index];
    byId('sequence').value = index;
    byId('frame').max = Math.max(0, sequence.stills.length - 1);
    byId('facts').textContent = factsOf();
    return go(sequence.stills.length ? nearestStill(frameIndex) : 0);
  };
  // By the name of a sequence and the number of a frame.
  const showFrame = (name, frame) => {
    const index = data.sequences.findIndex((one) => one.name === name);
    if (index < 0) return;
    show(index, Math.max(0, data.sequences[index].frame.indexOf(frame)));
    byId('browser').scrollIntoView();
  };

  // Share of the frames with an aircraft in which the best detector finds all of them.
  const shareOf = (one) => {
    const shares = one.detectors.map(({ found }) => {
      const frames = [...found].filter((letter) => letter !== '.');
      return frames.length ? frames.filter((letter) => letter === 'f').length / frames.length : null;
    }).filter((share) => share !== null);
    return shares.length ? Math.max(...shares) : null;
  };

  const wordsOf = (one) => {
    if (!one.detectors.length) return `${one.name} (no results)`;
    const share = shareOf(one);
    return `${one.name}${share === null ? ' (no aircraft)' : ` (found in ${number(100 * share)} %)`}`;
  };

  const begin = () => {
    airtruth.beginPlayer({
      sequences: data.sequences, wordsOf, shown: detectors, hidden, redraw: drawFrame, show, current: () => sequence, go, stop,
    });
    byId('weak').addEventListener('change', drawFrame);
    byId('strip').addEventListener('click', (event) => {
      stop();
      const index = (event.offsetX / byId('strip').clientWidth) * sequence.frame.length;
      if (sequence.stills.length) go(nearestStill(index));
    });
    window.addEventListener('resize', () => { if (sequence) drawStrip(); });
    const first = data.sequences.find((one) => one.detectors.length && one.stills.length) || data.sequences[0];
    if (first) show(first.index);
  };
  return { begin, showFrame };
};
