// SPDX-License-Identifier: Apache-2.0
import {clamp} from '../model/geometry';

import {h, say, text} from './part';

export interface NumberOptions {
  label: string;
  unit: string;
  step?: number;
  min?: number;
  max?: number;
  isLabelHidden?: boolean;
  placeholder?: string;
  emptied?: () => void;  // where nothing is a value
}

const fieldOf = new WeakMap<EventTarget, NumberField>();

// A number with its name and unit, taken when it is entered. What is no number in its range is refused in words, and
// the field has its last value again when it is left.
export class NumberField {
  readonly element: HTMLElement;
  readonly input: HTMLInputElement;
  private value: number|null = null;
  private isTyped = false;
  private words = h('span', {class: 'expected', role: 'alert', hidden: true});
  private range: {min: number; max: number; unit: string; why: string};

  constructor(private options: NumberOptions, private taken: (value: number) => void) {
    this.range = {min: options.min ?? -Infinity, max: options.max ?? Infinity, unit: options.unit, why: ''};
    this.input = h('input', {
      type: 'number',
      step: 'any',
      placeholder: options.placeholder,
      'aria-label': `${options.label}${options.unit ? `, ${options.unit}` : ''}`,
      oninput: () => {
        this.isTyped = true;
        this.mark();
      },
      onchange: () => this.take(),
      onblur: () => this.left(),
      onkeydown: ((event: KeyboardEvent) => this.key(event)) as EventListener,
    });
    fieldOf.set(this.input, this);
    const unit = options.unit ? h('span', {class: 'unit', 'aria-hidden': 'true'}, options.unit) : null;
    this.element =
        h('label', {class: 'field'}, options.isLabelHidden ? null : h('span', {class: 'name'}, options.label),
          h('span', {class: 'entry'}, this.input, unit), h('span', {}, this.words));
  }

  // What is expected from now on. `why`: "between the moments beside it".
  limit(min: number, max: number, unit = this.options.unit, why = ''): void {
    this.range = {min, max, unit, why};
  }

  // Leaves alone what is being typed.
  show(value: number|null): void {
    this.value = value;
    const isHere = document.activeElement === this.input;
    if (isHere && (this.isTyped || (this.input.value !== '' && this.input.valueAsNumber === value))) return;
    if (this.input.value !== this.shown) this.restore();
  }

  // As it was before it was typed in; whether that was refused.
  restore(): boolean {
    const wasRefused = this.input.getAttribute('aria-invalid') === 'true';
    this.isTyped = false;
    this.input.value = this.shown;
    this.input.removeAttribute('aria-invalid');
    this.words.hidden = true;
    return wasRefused;
  }

  private get shown(): string {
    return this.value === null ? '' : String(this.value);
  }

  private take(): void {
    if (!this.mark() || !this.isTyped) return;
    this.isTyped = false;
    if (this.input.value !== '')
      this.taken(this.input.valueAsNumber);
    else
      this.options.emptied?.();
  }

  // With a text that is refused.
  private left(): void {
    if (this.restore()) say(`${this.options.label}: ${this.value ?? 'nothing'} stays. ${this.expected}`);
  }

  // Whether what is entered is a number in its range, or nothing where nothing was. The browser would ask for whole
  // steps as well.
  private mark(): boolean {
    const {value, valueAsNumber, validity} = this.input;
    const {min, max} = this.range;
    const isAsBefore = value === '' && (this.value === null || this.options.emptied) && !validity.badInput;
    const isGood = isAsBefore || (Number.isFinite(valueAsNumber) && valueAsNumber >= min && valueAsNumber <= max);
    this.input.setAttribute('aria-invalid', String(!isGood));
    text(this.words, this.expected);
    this.words.hidden = isGood;
    return isGood;
  }

  private get expected(): string {
    const {min, max, unit, why} = this.range;
    if (min > max) return `There is no number ${why}.`;
    const [low, high] = [Number.isFinite(min), Number.isFinite(max)];
    const range = low && high ? ` from ${min} to ${max}` : low ? `, ${min} or more` : high ? `, ${max} or less` : '';
    return `Expected a number${range}${unit && (low || high ? ' ' : ' of ')}${unit}${why && `, ${why}`}.`;
  }

  private key(event: KeyboardEvent): void {
    const sign = {ArrowUp: 1, ArrowDown: -1}[event.key];
    if (!sign || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    const {min, max} = this.range;
    const step = sign * (this.options.step ?? 1) * (event.shiftKey ? 10 : 1);
    const from = Number.isFinite(this.input.valueAsNumber) ? this.input.valueAsNumber : 0;
    this.input.value = String(clamp(Number((from + step).toFixed(3)), min, max));
    this.isTyped = true;
    this.take();
  }
}

// The field of an input as it was before it was typed in; whether what was typed had been refused.
export const restored = (input: EventTarget|null): boolean => (input && fieldOf.get(input)?.restore()) ?? false;

export interface SliderOptions {
  label: string;
  min: number;
  max: number;
  isLogarithmic?: boolean;
  shown: (value: number) => string;
}

// A factor or an angle by a slider, with its value in words.
export class Slider {
  readonly element: HTMLElement;
  readonly input: HTMLInputElement;
  private output = h('output', {});
  private isHeld = false;

  constructor(
      private options: SliderOptions, moved: (value: number, moved_ms: number, isBegin: boolean) => void,
      ended: () => void) {
    const map = options.isLogarithmic ? Math.log2 : (v: number) => v;
    this.input = h('input', {
      type: 'range',
      min: map(options.min),
      max: map(options.max),
      step: 0.01,
      'aria-label': options.label,
      oninput: (event: Event) => {
        moved(this.value, event.timeStamp, !this.isHeld);
        this.isHeld = true;
        this.word(this.value);
      },
      onchange: () => {
        this.isHeld = false;
        ended();
      },
    });
    this.element = h('label', {class: 'slider'}, h('span', {class: 'name'}, options.label), this.input, this.output);
  }

  private get value(): number {
    const v = this.input.valueAsNumber;
    return Number((this.options.isLogarithmic ? 2 ** v : v).toPrecision(3));
  }

  show(value: number): void {
    if (this.isHeld) return;
    const shown = String(this.options.isLogarithmic ? Math.log2(value) : value);
    if (this.input.value !== shown) this.input.value = shown;
    this.word(value);
  }

  private word(value: number): void {
    const words = this.options.shown(value);
    this.output.textContent = words;
    this.input.setAttribute('aria-valuetext', words);
  }
}

// A line along which a number is chosen. `limits`: its ends, its step and where it begins.
export function rangeInput(
    label: string, moved: (value: number) => void,
    limits: {min: number; max?: number; value: number; step: number}): HTMLInputElement {
  const input: HTMLInputElement =
      h('input', {type: 'range', 'aria-label': label, oninput: () => moved(input.valueAsNumber), ...limits});
  return input;
}

export function choiceField(label: string, options: [string, string][], taken: (value: string) => void):
    {element: HTMLElement; select: HTMLSelectElement} {
  const select: HTMLSelectElement =
      h('select', {'aria-label': label, onchange: () => taken(select.value)},
        ...options.map(([value, words]) => h('option', {value}, words)));
  return {
    element: h('label', {class: 'field'}, h('span', {class: 'name'}, label), h('span', {class: 'entry'}, select)),
    select
  };
}

export function tick(label: string, taken: (isOn: boolean) => void): {element: HTMLElement; input: HTMLInputElement} {
  const input: HTMLInputElement = h('input', {type: 'checkbox', onchange: () => taken(input.checked)});
  return {element: h('label', {class: 'tick'}, input, label), input};
}
