// SPDX-License-Identifier: Apache-2.0
import type {BoxPx, Rendered} from '../model/contract';
import {clamp, round} from '../model/geometry';
import type {Member} from '../model/store';
import {DialogPart} from './dialog';
import {tick} from './fields';
import {attribute, h, s, text} from './part';

const LEAST_OFF_S = 0.05;  // of two films, after which one is moved to the other's time

interface FilmBox {
  id: string;
  box: BoxPx;
}

// Rendering with its progress, and then the film over the original, parted by a line that is drawn aside.
export class RenderDialog extends DialogPart {
  protected readonly watches: Member[] = ['dialog', 'busy', 'progress', 'film', 'clip', 'state'];
  protected readonly name = 'render';
  protected readonly title_ = 'Render';
  private begin = h('button', {class: 'main', onclick: () => void this.studio.render()}, 'Render the clip');
  private cancel = h('button', {onclick: () => void this.studio.cancel()}, 'Cancel');
  private bar = h('progress', {'aria-label': 'Progress'});
  private words = h('output', {});
  private where = h('p', {class: 'hint'});
  private original = h('video', {muted: true, playsinline: true, preload: 'auto', 'aria-label': 'The original'});
  private rendered = h('video', {muted: true, playsinline: true, preload: 'auto', 'aria-label': 'With the aircraft'});
  private boxes = s('svg', {'aria-hidden': 'true'});
  private boxesOf = new Map<number, FilmBox[]>();
  private showsBoxes = tick('Boxes', () => this.showBoxes(this.rendered.currentTime));
  private stage = h('div', {class: 'films'});
  private line = h('div', {class: 'line', 'aria-hidden': 'true'});
  private swipe: HTMLInputElement = h('input', {
    type: 'range',
    min: 0,
    max: 100,
    value: 50,
    step: 0.5,
    'aria-label': 'Swipe between the original and the film',
    oninput: () => this.partFilms()
  });
  private play: HTMLButtonElement = h('button', {onclick: () => this.toggle()}, 'Play');
  private time: HTMLInputElement = h('input', {
    type: 'range',
    min: 0,
    max: 1,
    step: 0.001,
    value: 0,
    'aria-label': 'Time in the film',
    oninput: () => this.seek()
  });
  private film = h('div', {class: 'film'});
  private shown: Rendered|null = null;

  protected fill(): Node[] {
    this.stage.append(
        this.original, this.rendered, this.boxes, this.line, this.swipe, h('span', {class: 'left'}, 'original'),
        h('span', {class: 'right'}, 'with aircraft'));
    this.stage.addEventListener('pointermove', (event) => {
      if (event.buttons & 1) this.swipeTo(event);
    });
    this.stage.addEventListener('pointerdown', (event) => this.swipeTo(event));
    this.rendered.addEventListener('timeupdate', () => this.follow());
    this.rendered.addEventListener('ended', () => this.follow());
    // Numbered pictures are no video, and not every container is one that browsers play.
    this.original.addEventListener('error', () => {
      this.original.hidden = true;
    });
    this.rendered.addEventListener('error', () => {
      this.film.hidden = true;
      text(
          this.where, `The film is in ${this.shown?.folder ?? ''}; browsers play mp4 ([output] video), not this kind.`);
    });
    this.rendered.addEventListener('loadedmetadata', () => this.shape());
    this.rendered.addEventListener('seeked', () => this.showBoxes(this.rendered.currentTime));
    this.film.append(this.stage, h('div', {class: 'actions'}, this.play, this.time, this.showsBoxes.element));
    return [h('div', {class: 'actions'}, this.begin, this.cancel, this.bar, this.words), this.where, this.film];
  }

  protected override update(changed: Set<Member>): void {
    super.update(changed);
    const {busy, progress, film, dialog} = this.now;
    const isRendering = busy === 'render';
    this.begin.disabled = busy !== null;
    this.cancel.hidden = this.bar.hidden = !isRendering;
    if (isRendering && progress?.total) {
      this.bar.max = progress.total;
      this.bar.value = progress.done;
    } else {
      this.bar.removeAttribute('value');
    }
    text(
        this.words,
        isRendering && progress?.total ?
            `${progress.of === 'motion' ? 'Measuring motion, ' : ''}${progress.done} of ${progress.total} frames` :
            isRendering ? 'Beginning …' :
                          '');
    text(
        this.where,
        film ? `The film and its truth are in ${film.folder}` :
               'The film, its boxes and its truth are written as `airtruth render` writes them.');
    this.film.hidden = !film || isRendering;
    if (film && film !== this.shown) this.load(film);
    if (dialog !== 'render') this.pause();
  }

  private load(film: Rendered): void {
    this.shown = film;
    this.boxesOf = new Map(film.boxes);
    const token = encodeURIComponent(new URLSearchParams(location.search).get('token') ?? '');
    // A number of its own makes the browser ask again after another render.
    const address = (which: string) => `/film?token=${token}&which=${which}&of=${Date.now()}`;
    this.original.hidden = false;
    this.original.src = address('original');
    this.rendered.src = address('rendered');
    this.partFilms();
  }

  // As large as there is room for, with the boxes in the film's own pixels.
  private shape(): void {
    const {videoWidth, videoHeight} = this.rendered;
    this.stage.style.width = `min(100%, calc(62vh * ${videoWidth / videoHeight}))`;
    this.stage.style.aspectRatio = `${videoWidth} / ${videoHeight}`;
    attribute(this.boxes, 'viewBox', `0 0 ${videoWidth} ${videoHeight}`);
    this.showBoxes(this.rendered.currentTime);
    const next = (_: number, {mediaTime}: {mediaTime: number}) => {
      this.showBoxes(mediaTime);
      this.rendered.requestVideoFrameCallback?.(next);
    };
    this.rendered.requestVideoFrameCallback?.(next);
  }

  private showBoxes(time_s: number): void {
    const {clip} = this.now;
    const boxes =
        this.showsBoxes.input.checked && clip ? this.boxesOf.get(Math.round(time_s * clip.rate_hz)) ?? [] : [];
    this.boxes.replaceChildren(...boxes.map(
        ({id, box: [x, y, width, height]}) =>
            s('rect', {x: x - 2, y: y - 2, width: width + 4, height: height + 4}, s('title', {}, id))));
  }

  private swipeTo(event: PointerEvent): void {
    const box = this.stage.getBoundingClientRect();
    this.swipe.value = String(clamp((100 * (event.clientX - box.left)) / box.width, 0, 100));
    this.partFilms();
  }

  private partFilms(): void {
    const share = this.swipe.valueAsNumber;
    this.rendered.style.clipPath = this.boxes.style.clipPath = `inset(0 0 0 ${share}%)`;
    this.line.style.left = `${share}%`;
  }

  // The original may begin before the part that is used.
  private get offset_s(): number {
    const {clip} = this.now;
    return clip ? clip.first_frame / clip.rate_hz : 0;
  }

  private toggle(): void {
    if (this.rendered.paused) {
      void this.rendered.play().catch(() => undefined);
      void this.original.play().catch(() => undefined);
      text(this.play, 'Pause');
    } else {
      this.pause();
    }
  }

  private pause(): void {
    this.rendered.pause();
    this.original.pause();
    text(this.play, 'Play');
  }

  private seek(): void {
    this.rendered.currentTime = this.time.valueAsNumber * (this.rendered.duration || 0);
    this.original.currentTime = this.rendered.currentTime + this.offset_s;
  }

  private follow(): void {
    const {currentTime, duration, ended} = this.rendered;
    if (duration) this.time.value = String(round(currentTime / duration, 4));
    if (Math.abs(this.original.currentTime - currentTime - this.offset_s) > LEAST_OFF_S)
      this.original.currentTime = currentTime + this.offset_s;
    if (ended) this.pause();
  }
}
