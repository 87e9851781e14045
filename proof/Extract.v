(* SPDX-License-Identifier: BSD-3-Clause *)
(** The checker as OCaml. Trusted are Coq's extraction and the lines below: integers are those of zarith (program/big.ml),
    counts and numbers of frames are OCaml's int, names are OCaml's strings. *)
From Coq Require Import ZArith String.
From Coq Require Extraction ExtrOcamlBasic ExtrOcamlNatInt ExtrOcamlNativeString.
From FclArtic Require Import Statement Numbers Meaning Reasons Witness Walk.

Extract Inductive positive => "Big.t" [ "Big.double_one" "Big.double" "Big.one" ] "Big.case_positive".
Extract Inductive Z => "Big.t" [ "Big.zero" "Big.same" "Big.neg" ] "Big.case_z".
Extract Inlined Constant Z.add => "Big.add".
Extract Inlined Constant Z.sub => "Big.sub".
Extract Inlined Constant Z.mul => "Big.mul".
Extract Inlined Constant Z.opp => "Big.neg".
Extract Inlined Constant Z.abs => "Big.abs".
Extract Inlined Constant Z.max => "Big.max".
Extract Inlined Constant Z.min => "Big.min".
Extract Inlined Constant Z.sgn => "Big.sgn".
Extract Inlined Constant Z.div => "Big.div".
Extract Inlined Constant Z.shiftr => "Big.shiftr".
Extract Inlined Constant Z.shiftl => "Big.shiftl".
Extract Inlined Constant Z.pow => "Big.pow".
Extract Inlined Constant Z.sqrt => "Big.sqrt".
Extract Inlined Constant Z.sqrt_up => "Big.sqrt_up".
Extract Inlined Constant Z.log2 => "Big.log2".
Extract Inlined Constant Z.eqb => "Big.equal".
Extract Inlined Constant Z.leb => "Big.leb".
Extract Inlined Constant Z.ltb => "Big.ltb".
Extract Inlined Constant Z.of_nat => "Big.of_int".
Extract Inlined Constant Z.to_nat => "Big.to_nat".

Extraction "checker.ml" prepare_world accepts_prepared accepts_meeting checked has_rotation nothing is_meaningful reasons_ok pieces_join.
