// SPDX-License-Identifier: Apache-2.0
import {h} from './part';

export interface NumberOptions {
  label: string;
  unit: string;
  step?: number;
  min?: number;
  max?: number;
  isLabelHidden?: boolean;
  placeholder?: string;
  taken: (value: number) => void;
}

// A number with its name and unit, taken when it is entered.
export class NumberField {
  readonly element: HTMLElement;
  readonly input: HTMLInputElement;

  constructor(private options: NumberOptions) {
    this.input = h('input', {
      type: 'number',
      step: 'any',
      placeholder: options.placeholder,
      'aria-label': `${options.label}${options.unit ? `, ${options.unit}` : ''}`,
      oninput: () => this.mark(),
      onchange: () => {
        if (this.mark()) options.taken(this.input.valueAsNumber);
      },
      onkeydown: ((event: KeyboardEvent) => this.key(event)) as EventListener,
    });
    const unit = options.unit ? h('span', {class: 'unit', 'aria-hidden': 'true'}, options.unit) : null;
    this.element =
        h('label', {class: 'field'}, options.isLabelHidden ? null : h('span', {class: 'name'}, options.label),
          h('span', {class: 'entry'}, this.input, unit));
  }

  // Whether what is entered is a number in its range. The browser would ask for whole steps as well.
  private mark(): boolean {
    const value = this.input.valueAsNumber;
    const {min = -Infinity, max = Infinity} = this.options;
    const isGood = Number.isFinite(value) && value >= min && value <= max;
    this.input.setAttribute('aria-invalid', String(!isGood));
    return isGood;
  }

  private key(event: KeyboardEvent): void {
    const sign = {ArrowUp: 1, ArrowDown: -1}[event.key];
    if (!sign || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    const step = sign * (this.options.step ?? 1) * (event.shiftKey ? 10 : 1);
    this.input.value =
        String(Number(((Number.isFinite(this.input.valueAsNumber) ? this.input.valueAsNumber : 0) + step).toFixed(3)));
    if (this.mark()) this.options.taken(this.input.valueAsNumber);
  }

  // Leaves alone what is being typed.
  show(value: number|null): void {
    const shown = value === null ? '' : String(value);
    const isTyped =
        document.activeElement === this.input && this.input.value !== '' && this.input.valueAsNumber === value;
    if (isTyped || this.input.value === shown) return;
    this.input.value = shown;
    this.input.removeAttribute('aria-invalid');
  }
}

export interface SliderOptions {
  label: string;
  min: number;
  max: number;
  isLogarithmic?: boolean;
  step?: number;
  shown: (value: number) => string;
  moved: (value: number, moved_ms: number, isBegin: boolean) => void;
  ended: () => void;
}

// A factor or an angle by a slider, with its value in words.
export class Slider {
  readonly element: HTMLElement;
  readonly input: HTMLInputElement;
  private output = h('output', {});
  private isHeld = false;

  constructor(private options: SliderOptions) {
    const map = options.isLogarithmic ? Math.log2 : (v: number) => v;
    this.input = h('input', {
      type: 'range',
      min: map(options.min),
      max: map(options.max),
      step: options.step ?? 0.01,
      'aria-label': options.label,
      oninput: (event: Event) => {
        options.moved(this.value, event.timeStamp, !this.isHeld);
        this.isHeld = true;
        this.word(this.value);
      },
      onchange: () => {
        this.isHeld = false;
        options.ended();
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
