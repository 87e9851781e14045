(* SPDX-License-Identifier: BSD-3-Clause *)
(** * Sine and cosine of numbers and of Taylor models *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement Numbers.
Open Scope R_scope.

Lemma abs_one_0 : Rabs 0 <= 1.
Proof. rewrite Rabs_R0. lra. Qed.

(** ** Of a constant model

    The partial sums of the power series lie on both sides of sine and cosine (Coq's library: [pre_sin_bound],
    [pre_cos_bound]). A state holds the power [term] = a^k / k! and the [sum] so far; the next term is
    term * a^2 / ((k+1) (k+2)), with the other sign. *)
Record series := Series { term : tm; sum : tm }.

(** One step, for a sum whose last term has the power k and the sign [plus]. *)
Definition next_term (z : tm) (k : Z) (plus : bool) (x : series) : series :=
  let next := tm_div (tm_mul (term x) z) ((k + 1) * (k + 2)) in
  Series next (if plus then tm_sub (sum x) next else tm_add (sum x) next).

(** Terms 0 to n of the series that begins with the power [first], 0 or 1. *)
Fixpoint partial (z x0 : tm) (first : Z) (n : nat) : series :=
  match n with
  | O => Series x0 x0
  | S n' => next_term z (2 * Z.of_nat n' + first) (Nat.even n') (partial z x0 first n')
  end.

Definition power_term (a : R) (first n : nat) : R := a ^ (2 * n + first) / INR (fact (2 * n + first)).
Definition series_sum (a : R) (first n : nat) : R := sum_f_R0 (fun i => (-1) ^ i * power_term a first i) n.

Lemma power_term_S a first n :
  power_term a first (S n) =
  power_term a first n * (a * a) / IZR ((2 * Z.of_nat n + Z.of_nat first + 1) * (2 * Z.of_nat n + Z.of_nat first + 2)).
Proof.
  unfold power_term. replace (2 * S n + first)%nat with (S (S (2 * n + first))) by lia.
  set (k := (2 * n + first)%nat).
  replace (2 * Z.of_nat n + Z.of_nat first)%Z with (Z.of_nat k) by (unfold k; lia).
  rewrite mult_IZR, !plus_IZR, <- INR_IZR_INZ.
  change (fact (S (S k))) with (S (S k) * (S k * fact k))%nat. rewrite !mult_INR, !S_INR, <- !tech_pow_Rmult.
  pose proof (pos_INR k). pose proof (INR_fact_neq_0 k). field. repeat split; try lra; assumption.
Qed.

Lemma sign n : (-1) ^ n = if Nat.even n then 1 else -1.
Proof.
  induction n as [|n IH]; [reflexivity|]. rewrite <- tech_pow_Rmult, IH, Nat.even_succ, <- Nat.negb_even.
  destruct (Nat.even n); cbn; lra.
Qed.

(** For any terms T that follow each other so. *)
Definition follows (T : nat -> R) (y : R) (first : nat) : Prop :=
  forall n, T (S n) = T n * y / IZR ((2 * Z.of_nat n + Z.of_nat first + 1) * (2 * Z.of_nat n + Z.of_nat first + 2)).
Definition signed_sum (T : nat -> R) (n : nat) : R := sum_f_R0 (fun i => (-1) ^ i * T i) n.

Lemma partial_holds s T y z x0 first n : follows T y first -> Rabs s <= 1 -> holds z s y -> holds x0 s (T O) ->
  let p := partial z x0 (Z.of_nat first) n in
  holds (term p) s (T n) /\ holds (sum p) s (signed_sum T n).
Proof.
  intros HT Hs Hz H0. induction n as [|n [IHt IHs]].
  - cbn [partial term sum]. split; [exact H0|]. unfold signed_sum. cbn [sum_f_R0].
    replace ((-1) ^ 0 * T O) with (T O) by (cbn; ring). exact H0.
  - assert (N : holds (tm_div (tm_mul (term (partial z x0 (Z.of_nat first) n)) z)
        ((2 * Z.of_nat n + Z.of_nat first + 1) * (2 * Z.of_nat n + Z.of_nat first + 2))) s (T (S n))).
    { rewrite HT. apply holds_div; [lia | exact Hs|]. apply holds_mul; assumption. }
    cbn [partial]. unfold next_term. cbn [term sum]. split; [exact N|].
    unfold signed_sum. cbn [sum_f_R0]. fold (signed_sum T n).
    rewrite sign, Nat.even_succ, <- Nat.negb_even. destruct (Nat.even n); cbn [negb].
    + eapply holds_eq; [|apply holds_sub; [exact IHs | exact N]]. ring.
    + eapply holds_eq; [|apply holds_add; [exact IHs | exact N]]. ring.
Qed.

(** Enough for numbers up to 2: 2^28 / 28! < 2^-69. *)
Definition terms : nat := 13.

(** The sum of terms 0 to 13 is off by the 14th at most. *)
Definition series_tm (z x0 : tm) (first : Z) : tm :=
  let p := partial z x0 first terms in
  widen (sum p) (bound (term (next_term z (2 * Z.of_nat terms + first) (Nat.even terms) p))).

Lemma series_holds s T yy z x0 first y : follows T yy first -> Rabs s <= 1 -> holds z s yy -> holds x0 s (T O) ->
  signed_sum T terms <= y <= signed_sum T (S terms) ->
  holds (series_tm z x0 (Z.of_nat first)) s y.
Proof.
  intros HT Hs Hz H0 [L U]. destruct (partial_holds s T yy z x0 first terms HT Hs Hz H0) as [_ Hp].
  destruct (partial_holds s T yy z x0 first (S terms) HT Hs Hz H0) as [Ht _].
  unfold series_tm. eapply holds_widen; [exact Hp|].
  pose proof (bound_ge _ _ _ Hs Ht) as B.
  change (partial z x0 (Z.of_nat first) (S terms)) with
    (next_term z (2 * Z.of_nat terms + Z.of_nat first) (Nat.even terms) (partial z x0 (Z.of_nat first) terms)) in B.
  eapply Rle_trans; [|exact B].
  assert (E : signed_sum T (S terms) = signed_sum T terms + (-1) ^ (S terms) * T (S terms)) by reflexivity.
  rewrite E in U. rewrite sign in U. change (Nat.even (S terms)) with true in U. cbn iota in U.
  rewrite (Rabs_right (y - _)) by lra. pose proof (Rle_abs (T (S terms))). lra.
Qed.

Lemma sin_is_series a n : sin_approx a n = series_sum a 1 n.
Proof. reflexivity. Qed.
Lemma cos_is_series a n : cos_approx a n = series_sum a 0 n.
Proof.
  unfold cos_approx, series_sum. apply sum_eq. intros i _. unfold cos_term, power_term.
  replace (2 * i + 0)%nat with (2 * i)%nat by lia. reflexivity.
Qed.

(** Sine and cosine of a model of a number in [0, 2]. *)
Definition sincos_base (x : tm) : tm * tm :=
  let z := tm_mul x x in (series_tm z x 1, series_tm z tm_one 0).

Lemma sincos_base_holds s a x : Rabs s <= 1 -> 0 <= a <= 2 -> holds x s a ->
  holds (fst (sincos_base x)) s (sin a) /\ holds (snd (sincos_base x)) s (cos a).
Proof.
  intros Hs Ha Hx. assert (Hz : holds (tm_mul x x) s (a * a)) by (apply holds_mul; assumption).
  unfold sincos_base. cbn [fst snd]. split.
  - change 1%Z with (Z.of_nat 1). apply series_holds with (T := power_term a 1) (yy := a * a); [intro; apply power_term_S | exact Hs | exact Hz | |].
    + eapply holds_eq; [|exact Hx]. unfold power_term. cbn. field.
    + change (signed_sum (power_term a 1)) with (series_sum a 1). rewrite <- !sin_is_series. exact (pre_sin_bound a 6 ltac:(lra) ltac:(lra)).
  - change 0%Z with (Z.of_nat 0). apply series_holds with (T := power_term a 0) (yy := a * a); [intro; apply power_term_S | exact Hs | exact Hz | |].
    + eapply holds_eq; [|apply holds_one]. unfold power_term. cbn. field.
    + change (signed_sum (power_term a 0)) with (series_sum a 0). rewrite <- !cos_is_series. exact (pre_cos_bound a 6 ltac:(lra) ltac:(lra)).
Qed.

(** Of 2^k times the number. *)
Fixpoint doubled (k : nat) (x : tm * tm) : tm * tm :=
  match k with
  | O => x
  | S k' =>
      let (sn, cs) := doubled k' x in
      let p := tm_mul sn cs in let q := tm_mul sn sn in
      (tm_add p p, tm_sub tm_one (tm_add q q))
  end.

Lemma doubled_holds s a x k : Rabs s <= 1 -> holds (fst x) s (sin a) -> holds (snd x) s (cos a) ->
  holds (fst (doubled k x)) s (sin (2 ^ k * a)) /\ holds (snd (doubled k x)) s (cos (2 ^ k * a)).
Proof.
  intros Hs H1 H2. induction k as [|k IH].
  - cbn [doubled pow]. rewrite Rmult_1_l. split; assumption.
  - cbn [doubled]. destruct (doubled k x) as [sn cs]. cbn [fst snd] in *. destruct IH as [I1 I2].
    rewrite <- tech_pow_Rmult, Rmult_assoc. set (b := 2 ^ k * a) in *. split.
    + rewrite sin_2a. eapply holds_eq; [|apply holds_add; apply holds_mul; eassumption]. ring.
    + rewrite cos_2a_sin. eapply holds_eq;
        [|apply holds_sub; [apply holds_one | apply holds_add; apply holds_mul; eassumption]]. ring.
Qed.

(** How often |x| is halved until it is below 2. *)
Definition halvings (x : Z) : nat := Z.to_nat (Z.log2 x - 64).

Definition sincos_number (x : Z) : tm * tm :=
  let b := Z.abs x in
  let k := halvings b in
  let y := if Nat.eqb k 0 then const b 0 else const (Z.shiftr b (Z.of_nat k)) 1 in
  let (sn, cs) := doubled k (sincos_base y) in
  (if Z.ltb x 0 then tm_opp sn else sn, cs).

Lemma halvings_enough b : (0 <= b)%Z -> (b < 2 * one * 2 ^ Z.of_nat (halvings b))%Z.
Proof.
  intros Hb. destruct (Z.eq_dec b 0) as [->|N].
  - apply Z.mul_pos_pos; [reflexivity | apply Z.pow_pos_nonneg; lia].
  - pose proof (Z.log2_spec b ltac:(lia)) as [_ U]. pose proof (Z.log2_nonneg b).
    unfold halvings. change (2 * one)%Z with (2 ^ 65)%Z. rewrite <- Z.pow_add_r by lia.
    eapply Z.lt_le_trans; [exact U|]. apply Z.pow_le_mono_r; lia.
Qed.

Lemma sincos_number_holds s x : Rabs s <= 1 ->
  holds (fst (sincos_number x)) s (sin (V x)) /\ holds (snd (sincos_number x)) s (cos (V x)).
Proof.
  intros Hs. unfold sincos_number. set (b := Z.abs x). set (k := halvings b).
  assert (P2 : 0 < 2 ^ k) by (apply pow_lt; lra).
  assert (PZ : IZR (2 ^ Z.of_nat k) = 2 ^ k) by (rewrite <- pow_IZR; reflexivity).
  set (a := V b / 2 ^ k).
  assert (Hb : 0 <= V b) by (rewrite <- V_0; apply V_le; unfold b; lia).
  assert (Ha : 0 <= a <= 2).
  { unfold a. split.
    - apply Rmult_le_pos; [exact Hb | left; apply Rinv_0_lt_compat, P2].
    - apply Rmult_le_reg_r with (2 ^ k); [exact P2|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
      pose proof (halvings_enough b ltac:(unfold b; lia)) as E. fold k in E. apply Z.lt_le_incl, V_le in E.
      unfold V in E. rewrite !mult_IZR, PZ in E. pose proof ulp_one.
      replace (2 * IZR one * 2 ^ k * ulp) with (2 * 2 ^ k * (ulp * IZR one)) in E by ring.
      rewrite ulp_one in E. unfold V. lra. }
  set (y := if Nat.eqb k 0 then const b 0 else const (Z.shiftr b (Z.of_nat k)) 1).
  assert (Hy : holds y s a).
  { unfold y, a. destruct (Nat.eqb_spec k 0) as [->|_].
    - eapply holds_eq; [|apply holds_exact]. cbn. field.
    - apply holds_const. pose proof (shiftr_err b (Z.of_nat k) ltac:(lia)) as E. rewrite PZ in E.
      rewrite (V_ulps 1). apply Rabs_le. lra. }
  destruct (sincos_base_holds s a y Hs Ha Hy) as [B1 B2].
  destruct (doubled_holds s a (sincos_base y) k Hs B1 B2) as [D1 D2].
  replace (2 ^ k * a) with (V b) in * by (unfold a; field; lra).
  destruct (doubled k (sincos_base y)) as [sn cs]. cbn [fst snd] in *.
  destruct (Z.ltb_spec x 0) as [L|G].
  - assert (E : V x = - V b) by (unfold b; rewrite <- V_opp; f_equal; lia).
    rewrite E, sin_neg, cos_neg. split; [apply holds_opp; exact D1 | exact D2].
  - assert (b = x) as -> by (unfold b; lia). split; assumption.
Qed.

(** ** Of a model: sin (x0 + d) and cos (x0 + d), with few powers of d *)

Lemma sin_small_pos d : 0 <= d <= 2 -> 0 <= sin d - (d - d * d * d / 6) <= d * d * d * d * d / 120.
Proof.
  intros H. pose proof (pre_sin_bound d 0 ltac:(lra) ltac:(lra)) as [L U].
  cbn in L, U. unfold sin_term in *. cbn in L, U. lra.
Qed.
Lemma sin_small d D : Rabs d <= D -> D <= 2 -> Rabs (sin d - (d - d * d * d / 6)) <= D * D * (D * D) * D / 120.
Proof.
  intros H HD.
  assert (K : forall e, 0 <= e <= D -> Rabs (sin e - (e - e * e * e / 6)) <= D * D * (D * D) * D / 120).
  { intros e He. pose proof (sin_small_pos e ltac:(lra)) as [L U]. rewrite Rabs_right by lra.
    eapply Rle_trans; [exact U|].
    assert (e * e <= D * D) by (apply Rmult_le_compat; lra).
    assert (e * e * (e * e) <= D * D * (D * D)) by (apply Rmult_le_compat; nra).
    assert (e * e * (e * e) * e <= D * D * (D * D) * D) by (apply Rmult_le_compat; nra). lra. }
  apply abs_in in H. destruct (Rle_lt_dec 0 d) as [P|N]; [apply K; lra|].
  specialize (K (- d) ltac:(lra)). rewrite sin_neg in K.
  replace (sin d - (d - d * d * d / 6)) with (- (- sin d - (- d - - d * - d * - d / 6))) by field.
  rewrite Rabs_Ropp. exact K.
Qed.
Lemma cos_small d D : Rabs d <= D -> D <= 2 ->
  Rabs (cos d - (1 - d * d / 2 + d * d * (d * d) / 24)) <= D * D * (D * D) * (D * D) / 720.
Proof.
  intros H HD. apply abs_in in H.
  pose proof (pre_cos_bound d 0 ltac:(lra) ltac:(lra)) as [_ U]. pose proof (pre_cos_bound d 1 ltac:(lra) ltac:(lra)) as [L _].
  cbn in L, U. unfold cos_term in *. cbn in L, U.
  assert (d * d <= D * D) by nra. assert (0 <= d * d) by nra.
  assert (d * d * (d * d) <= D * D * (D * D)) by (apply Rmult_le_compat; lra).
  assert (d * d * (d * d) * (d * d) <= D * D * (D * D) * (D * D)) by (apply Rmult_le_compat; nra).
  apply Rabs_le. split; lra.
Qed.

Definition two : Z := (2 * one)%Z.

Definition sincos (x : tm) : tm * tm :=
  let (s0, k0) := sincos_number (c0 x) in
  let d := Tm 0 (c1 x) (c2 x) (rem x) in
  if is_const x && Z.eqb (rem x) 0 then (s0, k0)
  else
    let D := bound d in
    if Z.ltb two D then (const 0 one, const 0 one)
    else
      let d2 := tm_mul d d in
      let D2 := mulup D D in let D4 := mulup D2 D2 in
      let sn := widen (tm_sub d (tm_div (tm_mul d2 d) 6)) (divz (mulup D4 D) 120 + 1) in
      let cs := widen (tm_add (tm_sub tm_one (tm_div d2 2)) (tm_div (tm_mul d2 d2) 24)) (divz (mulup D4 D2) 720 + 1) in
      (tm_add (tm_mul s0 cs) (tm_mul k0 sn), tm_sub (tm_mul k0 cs) (tm_mul s0 sn)).

Lemma V_two : V two = 2.
Proof. unfold two, V. rewrite mult_IZR, Rmult_assoc, (Rmult_comm (IZR one)), ulp_one. ring. Qed.

Lemma div_up a n x : (0 < n)%Z -> x <= V a -> x / IZR n <= V (divz a n + 1).
Proof.
  intros Hn Hx. pose proof (divz_err a n Hn). rewrite V_add, (V_ulps 1).
  assert (x / IZR n <= V a / IZR n); [|lra].
  apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat, IZR_lt; lia | exact Hx].
Qed.

Lemma mulup_le x y a b : 0 <= x <= V a -> 0 <= y <= V b -> 0 <= x * y <= V (mulup a b).
Proof.
  intros Hx Hy. split; [apply Rmult_le_pos; lra|]. eapply Rle_trans; [|apply mulup_ge]. apply Rmult_le_compat; lra.
Qed.

Lemma sincos_holds s x y : Rabs s <= 1 -> holds x s y ->
  holds (fst (sincos x)) s (sin y) /\ holds (snd (sincos x)) s (cos y).
Proof.
  intros Hs Hx. unfold sincos. pose proof (sincos_number_holds s (c0 x) Hs) as N.
  destruct (sincos_number (c0 x)) as [s0 k0]. cbn [fst snd] in N. destruct N as [N1 N2].
  set (d := Tm 0 (c1 x) (c2 x) (rem x)).
  assert (Hd : holds d s (y - V (c0 x))).
  { unfold holds, poly, d in *; cbn in *. rewrite V_0. 
    match goal with |- Rabs ?a <= _ => match type of Hx with Rabs ?b <= _ => replace a with b by ring end end. exact Hx. }
  destruct (is_const x && Z.eqb (rem x) 0) eqn:C.
  - rewrite andb_true_iff, Z.eqb_eq in C. destruct C as [C Z0]. apply is_const_const in C.
    rewrite C, Z0 in Hx. apply holds_const in Hx. rewrite V_0 in Hx. apply abs_in in Hx.
    replace y with (V (c0 x)) by lra. split; assumption.
  - destruct (Z.ltb_spec two (bound d)) as [G|L].
    + cbn [fst snd]. split; apply holds_const; rewrite V_0, V_one, Rminus_0_r; apply Rabs_le;
        [apply SIN_bound | apply COS_bound].
    + pose proof (bound_ge d s _ Hs Hd) as B. apply V_le in L. rewrite V_two in L.
      set (D := bound d) in *. set (e := y - V (c0 x)) in *.
      pose proof (sin_small e (V D) B L) as SB. pose proof (cos_small e (V D) B L) as CB.
      assert (P : 0 <= V D <= V D) by (pose proof (Rabs_pos e); lra).
      pose proof (mulup_le _ _ _ _ P P) as P2. pose proof (mulup_le _ _ _ _ P2 P2) as P4.
      pose proof (mulup_le _ _ _ _ P4 P) as P5. pose proof (mulup_le _ _ _ _ P4 P2) as P6.
      assert (H2 : holds (tm_mul d d) s (e * e)) by (apply holds_mul; assumption).
      set (sn := widen _ (divz (mulup (mulup (mulup D D) (mulup D D)) D) 120 + 1)).
      set (cs := widen _ (divz (mulup (mulup (mulup D D) (mulup D D)) (mulup D D)) 720 + 1)).
      assert (S : holds sn s (sin e)).
      { unfold sn. eapply holds_widen with (x := e - e * e * e / IZR 6).
        - apply holds_sub; [exact Hd|]. apply holds_div; [lia | exact Hs|]. apply holds_mul; assumption.
        - eapply Rle_trans; [exact SB|]. apply (div_up _ 120); [lia | apply P5]. }
      assert (C' : holds cs s (cos e)).
      { unfold cs. eapply holds_widen with (x := 1 - e * e / IZR 2 + e * e * (e * e) / IZR 24).
        - apply holds_add; [apply holds_sub; [apply holds_one|]|]; (apply holds_div; [lia | exact Hs|]); [exact H2|].
          apply holds_mul; assumption.
        - eapply Rle_trans; [exact CB|]. apply (div_up _ 720); [lia | apply P6]. }
      replace y with (V (c0 x) + e) by (unfold e; ring). rewrite sin_plus, cos_plus. cbn [fst snd]. split.
      * apply holds_add; apply holds_mul; assumption.
      * apply holds_sub; apply holds_mul; assumption.
Qed.

(** ** Of half a rotation vector's length

    For a vector of length r: sin(r/2) / r, or 1/2 where r is 0, and cos(r/2), from a model of r^2. The functions of r
    below are those of the angle r / 2^k. *)
Definition sin_part (r : R) (k : nat) : R := if Req_EM_T r 0 then / 2 ^ k else sin (r / 2 ^ k) / r.
Definition cos_part (r : R) (k : nat) : R := cos (r / 2 ^ k).

Definition part_term (r : R) (k n : nat) : R := / 2 ^ k * ((r / 2 ^ k) ^ (2 * n) / INR (fact (2 * n + 1))).

Lemma part_term_follows r k : follows (part_term r k) (r / 2 ^ k * (r / 2 ^ k)) 1.
Proof.
  intros n. unfold part_term. set (a := r / 2 ^ k). replace (2 * S n + 1)%nat with (S (S (2 * n + 1))) by lia.
  replace (2 * S n)%nat with (S (S (2 * n))) by lia. set (j := (2 * n + 1)%nat).
  replace (2 * Z.of_nat n + Z.of_nat 1)%Z with (Z.of_nat j) by (unfold j; lia).
  rewrite mult_IZR, !plus_IZR, <- INR_IZR_INZ.
  change (fact (S (S j))) with (S (S j) * (S j * fact j))%nat. rewrite !mult_INR, !S_INR, <- !tech_pow_Rmult.
  pose proof (pos_INR j). pose proof (INR_fact_neq_0 j). assert (2 ^ k <> 0) by (apply pow_nonzero; lra).
  field. repeat split; try lra; assumption.
Qed.

Lemma part_sum r k n : r <> 0 -> signed_sum (part_term r k) n = series_sum (r / 2 ^ k) 1 n / r.
Proof.
  intros N. unfold signed_sum, series_sum, Rdiv at 1. rewrite Rmult_comm, scal_sum. apply sum_eq. intros i _.
  unfold part_term, power_term. rewrite pow_add, pow_1. set (f := INR (fact _)). assert (f <> 0) by apply INR_fact_neq_0.
  assert (2 ^ k <> 0) by (apply pow_nonzero; lra). set (b := (r / 2 ^ k) ^ (2 * i)). field. repeat split; assumption.
Qed.

Lemma part_sum_0 k n : signed_sum (part_term 0 k) n = / 2 ^ k.
Proof.
  assert (Z0 : 0 / 2 ^ k = 0) by (unfold Rdiv; ring). induction n as [|n IH].
  - unfold signed_sum, part_term; cbn [sum_f_R0 pow fact Nat.mul Nat.add INR]. lra.
  - unfold signed_sum in *; cbn [sum_f_R0]. rewrite IH. unfold part_term. rewrite Z0, pow_i by lia. unfold Rdiv. ring.
Qed.

Lemma sin_part_bounds r k : 0 <= r / 2 ^ k <= 2 ->
  signed_sum (part_term r k) terms <= sin_part r k <= signed_sum (part_term r k) (S terms).
Proof.
  intros H. unfold sin_part. destruct (Req_EM_T r 0) as [->|N]; [rewrite !part_sum_0; lra|].
  assert (P : 0 < 2 ^ k) by (apply pow_lt; lra).
  assert (R0 : 0 < r).
  { assert (0 <= r); [|lra]. replace r with (r / 2 ^ k * 2 ^ k) by (field; lra). apply Rmult_le_pos; lra. }
  rewrite !part_sum by exact N. pose proof (pre_sin_bound (r / 2 ^ k) 6 ltac:(lra) ltac:(lra)) as [L U].
  rewrite sin_is_series in L, U. assert (I : 0 <= / r) by (left; apply Rinv_0_lt_compat; exact R0).
  split; apply Rmult_le_compat_r; assumption.
Qed.

Lemma parts_double r k : sin_part r k = 2 * (sin_part r (S k) * cos_part r (S k)) /\
  cos_part r k = 1 - 2 * (sin_part r (S k) * sin_part r (S k) * (r * r)).
Proof.
  assert (P : 0 < 2 ^ k) by (apply pow_lt; lra).
  assert (E : r / 2 ^ k = 2 * (r / 2 ^ S k)) by (cbn [pow]; field; lra). unfold sin_part, cos_part. rewrite E.
  set (b := r / 2 ^ S k). destruct (Req_EM_T r 0) as [Z0|N].
  - assert (b = 0) as -> by (unfold b; rewrite Z0; unfold Rdiv; ring). rewrite Rmult_0_r, cos_0, Z0. cbn [pow].
    split; [field; lra | ring].
  - rewrite sin_2a, cos_2a_sin. split; field; exact N.
Qed.

(** Numbers in [-1, 1] whose model says less. *)
Definition clamped (x : tm) : tm := if Z.ltb two (bound x) then const 0 one else x.
Lemma clamped_holds s x y : Rabs y <= 1 -> holds x s y -> holds (clamped x) s y.
Proof.
  intros Hy H. unfold clamped. destruct (Z.ltb two (bound x)); [|exact H]. apply holds_const.
  rewrite V_0, V_one, Rminus_0_r. exact Hy.
Qed.

Fixpoint parts_doubled (n : nat) (z : tm) (x : tm * tm) : tm * tm :=
  match n with
  | O => x
  | S n' =>
      let (a, c) := parts_doubled n' z x in
      let p := tm_mul a c in let q := tm_mul (tm_mul a a) z in
      (tm_add p p, clamped (tm_sub tm_one (tm_add q q)))
  end.

Lemma parts_doubled_holds s r z x k n : Rabs s <= 1 -> holds z s (r * r) ->
  holds (fst x) s (sin_part r (n + k)) -> holds (snd x) s (cos_part r (n + k)) ->
  holds (fst (parts_doubled n z x)) s (sin_part r k) /\ holds (snd (parts_doubled n z x)) s (cos_part r k).
Proof.
  intros Hs Hz. revert k. induction n as [|n IH]; intros k H1 H2; [split; assumption|].
  replace (S n + k)%nat with (n + S k)%nat in * by lia. specialize (IH (S k) H1 H2).
  cbn [parts_doubled]. destruct (parts_doubled n z x) as [a c]. cbn [fst snd] in *. destruct IH as [I1 I2].
  destruct (parts_double r k) as [E1 E2]. split.
  - rewrite E1. eapply holds_eq; [|apply holds_add; apply holds_mul; eassumption]. ring.
  - apply clamped_holds; [apply Rabs_le, COS_bound|]. rewrite E2.
    eapply holds_eq; [|apply holds_sub; [apply holds_one | apply holds_add; apply holds_mul;
      try exact Hs; try exact Hz; apply holds_mul; eassumption]]. ring.
Qed.

(** Sine and cosine parts of half the length, from r^2; none where the length may be beyond 2^60. *)
Definition half_parts (z : tm) : option (tm * tm) :=
  let n := Z.to_nat ((Z.log2 (bound z) - 64) / 2 + 1) in
  let y := tm_div z (4 ^ Z.of_nat (S n)) in
  if Nat.leb n 60 && Z.leb (bound y) (2 * two) then
    Some (parts_doubled n z (series_tm y (const (2 ^ (64 - Z.of_nat (S n))) 0) 1, series_tm y tm_one 0))
  else None.

Lemma half_parts_holds s r z x : 0 <= r -> Rabs s <= 1 -> holds z s (r * r) -> half_parts z = Some x ->
  holds (fst x) s (sin_part r 1) /\ holds (snd x) s (cos_part r 1).
Proof.
  intros Hr Hs Hz. unfold half_parts. set (n := Z.to_nat _). set (k := S n).
  set (y := tm_div z (4 ^ Z.of_nat k)).
  destruct (Nat.leb n 60 && Z.leb (bound y) (2 * two)) eqn:C; [|discriminate]. intros E.
  apply (f_equal (fun o => match o with Some p => p | None => x end)) in E. cbv beta iota in E. subst x.
  apply andb_true_iff in C. destruct C as [C1 C2]. apply Nat.leb_le in C1. apply Z.leb_le, V_le in C2.
  assert (P : 0 < 2 ^ k) by (apply pow_lt; lra). set (a := r / 2 ^ k).
  assert (Hy : holds y s (a * a)).
  { unfold y. eapply holds_eq; [|apply holds_div; [apply Z.pow_pos_nonneg; lia | exact Hs | exact Hz]].
    rewrite <- pow_IZR. replace (IZR 4) with (2 * 2) by (cbn; ring). rewrite Rpow_mult_distr. unfold a. field. lra. }
  assert (A0 : 0 <= a) by (apply Rmult_le_pos; [exact Hr | left; apply Rinv_0_lt_compat; exact P]).
  assert (A2 : a <= 2).
  { pose proof (bound_ge _ _ _ Hs Hy) as B. replace (2 * two)%Z with (two + two)%Z in C2 by lia.
    rewrite V_add, V_two in C2. rewrite Rabs_right in B by nra. nra. }
  apply (parts_doubled_holds s r z _ 1 n Hs Hz); cbn [fst snd];
    replace (n + 1)%nat with k by (unfold k; lia).
  - change 1%Z with (Z.of_nat 1). apply series_holds with (T := part_term r k) (yy := a * a);
      [apply part_term_follows | exact Hs | exact Hy | | apply sin_part_bounds; split; assumption].
    eapply holds_eq; [|apply holds_exact]. unfold part_term. cbn [Nat.mul Nat.add fact pow INR]. unfold V.
    rewrite <- (Z2Nat.id (64 - Z.of_nat k)) by (unfold k; lia). rewrite <- pow_IZR.
    set (d := Z.to_nat (64 - Z.of_nat k)). pose proof ulp_one as U.
    assert (ON : IZR one = 2 ^ d * 2 ^ k).
    { rewrite <- pow_add. replace (d + k)%nat with 64%nat by (unfold d, k; lia).
      change one with (2 ^ Z.of_nat 64)%Z. rewrite <- pow_IZR. reflexivity. }
    rewrite ON in U. apply Rmult_eq_reg_r with (2 ^ k); [|lra]. replace (/ 2 ^ k * (1 / 1) * 2 ^ k) with 1 by (field; lra).
    rewrite <- U. ring.
  - change 0%Z with (Z.of_nat 0). apply series_holds with (T := power_term a 0) (yy := a * a);
      [intro; apply power_term_S | exact Hs | exact Hy | |].
    + eapply holds_eq; [|apply holds_one]. unfold power_term. cbn. field.
    + change (signed_sum (power_term a 0)) with (series_sum a 0). rewrite <- !cos_is_series.
      exact (pre_cos_bound a 6 ltac:(lra) ltac:(lra)).
Qed.
