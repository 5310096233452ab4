// SPDX-License-Identifier: Apache-2.0
import type {Clip, FilmBox, Rendered} from '../model/contract';
import {clamp, frameAt, timeAt} from '../model/geometry';
import type {Member} from '../model/store';
import {DialogPart} from './dialog';
import {rangeInput, tick} from './fields';
import {attribute, button, h, s, text, token} from './part';

const MOST_AHEAD_S = 0.5;  // of one film to the other, beyond which it does not catch up by its speed
const CATCH_UP = 4;        // of its speed, for each second that it is ahead

// Rendering with its progress, and then the film over the original from the frame shown on, parted by a line that is
// drawn aside.
export class RenderDialog extends DialogPart {
  protected readonly watches: Member[] =
      ['dialog', 'busy', 'progress', 'film', 'clip', 'state', 'file', 'notices', 'connected'];
  protected readonly name = 'render';
  protected readonly title_ = 'Render';
  private begin = button('Render the clip', () => void this.studio.render(), {class: 'main'});
  private cancel = button('Cancel', () => void this.studio.cancel());
  private bar = h('progress', {'aria-label': 'Progress'});
  private words = h('output', {});
  private where = h('p', {class: 'hint'});
  private problem = h('p', {class: 'notice error'});
  private original = h('video', {muted: true, playsinline: true, preload: 'auto', 'aria-label': 'The original'});
  private rendered = h('video', {muted: true, playsinline: true, preload: 'auto', 'aria-label': 'With the aircraft'});
  private boxes = s('svg', {'aria-hidden': 'true'});
  private boxesOf = new Map<number, FilmBox[]>();
  private showsBoxes = tick('Boxes', () => this.showBoxes());
  private stage = h('div', {class: 'films'});
  private line = h('div', {class: 'line', 'aria-hidden': 'true'});
  private swipe = rangeInput(
      'Swipe between the original and the film', () => this.partFilms(), {min: 0, max: 100, value: 10, step: 0.5});
  private play = button('Play', () => this.toggle());
  private time = rangeInput('Frame of the film', (frame) => this.goTo(frame), {min: 0, step: 1, value: 0});
  private film = h('div', {class: 'film'});
  private shown: Rendered|null = null;
  private frame = 0;           // of the film, on the screen
  private originalFrame = -1;  // of the original
  private sought = -1;         // of the original, to save seeking again where it has no such frame

  protected fill(): Node[] {
    this.stage.append(
        this.original, this.rendered, this.boxes, this.line, this.swipe, h('span', {class: 'left'}, 'original'),
        h('span', {class: 'right'}, 'with aircraft'));
    this.stage.addEventListener('pointermove', (event) => {
      if (event.buttons & 1) this.swipeTo(event);
    });
    this.stage.addEventListener('pointerdown', (event) => this.swipeTo(event));
    this.tellFrames(this.rendered, () => 0, (frame) => this.came(frame));
    this.tellFrames(this.original, () => this.now.clip?.begin_s ?? 0, (frame) => {
      this.originalFrame = frame;
      this.follow();
    });
    this.rendered.addEventListener('ended', () => this.pause());
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
    this.film.append(this.stage, h('div', {class: 'actions'}, this.play, this.time, this.showsBoxes.element));
    return [
      h('div', {class: 'actions'}, this.begin, this.cancel, this.bar, this.words), this.where, this.problem, this.film
    ];
  }

  protected override update(changed: Set<Member>): void {
    super.update(changed);
    const {busy, progress, film, dialog, file, state, notices, connected} = this.now;
    const isRendering = busy === 'render';
    const name = state?.scene.name ?? file.replace(/^.*\//, '').replace(/\.toml$/, '');
    this.begin.disabled = busy !== null || !connected;
    // Notices are behind the dialog.
    const error = notices.filter((notice) => notice.kind === 'error').pop();
    this.problem.hidden = !error;
    text(this.problem, error?.line ?? '');
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
               `The film, its boxes and its truth will be in ${this.now.out}/${
                   name}, as \`airtruth render\` writes them. What is there is replaced.`);
    this.film.hidden = !film || isRendering;
    const isNew = film !== null && film !== this.shown;
    if (isNew) this.load(film);
    if (dialog !== 'render')
      this.pause();
    else if (film && (isNew || changed.has('dialog')))
      this.goTo(this.now.frame);
  }

  private load(film: Rendered): void {
    this.shown = film;
    this.boxesOf = new Map(film.boxes);
    // A number of its own makes the browser ask again after another render.
    const address = (which: string) => `/film?token=${token}&which=${which}&of=${Date.now()}`;
    this.original.hidden = false;
    this.original.src = address('original');
    this.rendered.src = address('rendered');
    attribute(this.time, 'max', (this.now.clip?.frames ?? 1) - 1);
    this.sought = this.originalFrame = -1;
    this.partFilms();
  }

  // Tells each frame of the clip that a film shows, from the clip's begin in it on. A browser may leave out the
  // callback of a frame, but never that a seek has ended.
  private tellFrames(film: HTMLVideoElement, begin_s: () => number, came: (frame: number) => void): void {
    const at = (time_s: number) => (this.now.clip ? frameAt(time_s - begin_s(), this.now.clip) : 0);
    const next = (_: number, {mediaTime}: {mediaTime: number}) => {
      film.requestVideoFrameCallback(next);
      came(Math.round(at(mediaTime)));
    };
    film.requestVideoFrameCallback?.(next);
    film.addEventListener('seeked', () => came(Math.round(at(film.currentTime) - 0.5)));
  }

  // As large as there is room for, with the boxes in the film's own pixels.
  private shape(): void {
    const {videoWidth, videoHeight} = this.rendered;
    this.stage.style.width = `min(100%, calc(62vh * ${videoWidth / videoHeight}))`;
    this.stage.style.aspectRatio = `${videoWidth} / ${videoHeight}`;
    attribute(this.boxes, 'viewBox', `0 0 ${videoWidth} ${videoHeight}`);
  }

  private showBoxes(): void {
    const boxes = this.showsBoxes.input.checked ? this.boxesOf.get(this.frame) ?? [] : [];
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

  private toggle(): void {
    if (!this.rendered.paused) return this.pause();
    if (this.rendered.ended) this.goTo(0);
    for (const film of [this.rendered, this.original]) void film.play().catch(() => undefined);
    text(this.play, 'Pause');
  }

  private pause(): void {
    for (const film of [this.rendered, this.original]) film.pause();
    text(this.play, 'Play');
    this.follow();
  }

  private goTo(frame: number): void {
    this.frame = frame;
    if (this.now.clip) seek(this.rendered, 0, frame, this.now.clip);
    this.follow();
  }

  // A frame of the film is on the screen.
  private came(frame: number): void {
    this.frame = frame;
    if (!this.rendered.seeking) this.time.value = String(frame);
    this.showBoxes();
    this.follow();
  }

  // The original shows the frame that the film shows: while both play it runs faster or slower until it does.
  private follow(): void {
    const {clip} = this.now;
    if (!this.shown || !clip) return;
    const wanted = this.frame;
    const ahead_s = (this.originalFrame - wanted) / clip.rate_hz;
    if (!this.rendered.paused && Math.abs(ahead_s) < MOST_AHEAD_S) {
      this.original.playbackRate = clamp(1 - CATCH_UP * ahead_s, 0.5, 1.5);
      this.sought = -1;
    } else if (this.originalFrame !== wanted && this.sought !== wanted) {
      this.sought = wanted;
      seek(this.original, clip.begin_s, wanted, clip);
    }
  }
}
customElements.define('studio-render', RenderDialog);

// By the middle of the frame, so that no rounding shows the one before.
function seek(film: HTMLVideoElement, begin_s: number, frame: number, clip: Clip): void {
  film.currentTime = begin_s + timeAt(frame + 0.5, clip);
}
